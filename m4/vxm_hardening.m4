# SPDX-License-Identifier: BSD-3-Clause
# Flags that make errors in memory harder to exploit: each where the compiler and the linker take it.

# VXM_HARDEN_COMPILER(VARIABLE, FLAGS, [CFLAGS-NAME = CFLAGS])
# Adds FLAGS to VARIABLE if a program compiles and links with them, without a warning, in the language that is current.
AC_DEFUN([VXM_HARDEN_COMPILER], [
AC_MSG_CHECKING([whether $_AC_CC takes $2])
vxm_saved_flags=$m4_default([$3], [CFLAGS])
m4_default([$3], [CFLAGS])="$2 $m4_default([$3], [CFLAGS]) -Werror"
AC_LINK_IFELSE([AC_LANG_PROGRAM([#include <stdio.h>], [char text@<:@16@:>@; return snprintf(text, sizeof text, "%d", 1) != 1;])],
  [$1="$$1 $2"; vxm_taken=yes], [vxm_taken=no])
m4_default([$3], [CFLAGS])=$vxm_saved_flags
AC_MSG_RESULT([$vxm_taken])
])

# VXM_HARDEN_LINKER(VARIABLE, FLAGS)
AC_DEFUN([VXM_HARDEN_LINKER], [
AC_MSG_CHECKING([whether the linker takes $2])
vxm_saved_flags=$LDFLAGS
LDFLAGS="$2 $LDFLAGS -Werror"
AC_LINK_IFELSE([AC_LANG_PROGRAM([], [])], [$1="$$1 $2"; vxm_taken=yes], [vxm_taken=no])
LDFLAGS=$vxm_saved_flags
AC_MSG_RESULT([$vxm_taken])
])

# VXM_HARDEN_FORTIFY(VARIABLE, CFLAGS-NAME)
# The checks of the C library work only where code is optimized. What the caller says of them stays as it is.
AC_DEFUN([VXM_HARDEN_FORTIFY], [
AC_MSG_CHECKING([for _FORTIFY_SOURCE with $_AC_CC])
vxm_level=no
AS_CASE([" $CPPFLAGS $$2 "], [*_FORTIFY_SOURCE*], [vxm_level="as given"], [
  vxm_saved_flags=$$2
  for vxm_try in 3 2; do
    test "x$vxm_level" = xno || continue
    $2="-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=$vxm_try $vxm_saved_flags -Werror"
    AC_COMPILE_IFELSE([AC_LANG_PROGRAM([
      #include <stdio.h>
      #if !defined(__OPTIMIZE__) || !defined(__USE_FORTIFY_LEVEL) || __USE_FORTIFY_LEVEL < $vxm_try
      #error "not at this level"
      #endif], [])],
      [vxm_level=$vxm_try; $1="$$1 -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=$vxm_try"])
  done
  $2=$vxm_saved_flags])
AC_MSG_RESULT([$vxm_level])
])

# VXM_HARDENING
# Gives VXM_HARDEN_CFLAGS, VXM_HARDEN_CXXFLAGS, VXM_HARDEN_LDFLAGS (of libraries and programs) and VXM_HARDEN_PIE_LDFLAGS (of
# programs), and vxm_hardening for the closing summary. Not with sanitizers, which have checks of their own.
AC_DEFUN([VXM_HARDENING], [
AC_ARG_ENABLE([hardening], [AS_HELP_STRING([--disable-hardening],
  [leave out stack protection, checks of buffers, read-only relocations and position-independent programs])],
  [], [enable_hardening=yes])
VXM_HARDEN_CFLAGS= VXM_HARDEN_CXXFLAGS= VXM_HARDEN_LDFLAGS= VXM_HARDEN_PIE_LDFLAGS=
vxm_hardening=no
AS_CASE([" $CFLAGS $CXXFLAGS $enable_sanitizers "],
  [*-fsanitize=* | *" yes "*], [vxm_hardening="no, with sanitizers"; enable_hardening=no])
AS_IF([test "x$enable_hardening" != xno], [
  m4_foreach_w([vxm_flag], [-fstack-protector-strong -fstack-clash-protection -fcf-protection -mbranch-protection=standard], [
    VXM_HARDEN_COMPILER([VXM_HARDEN_CFLAGS], vxm_flag)])
  VXM_HARDEN_COMPILER([VXM_HARDEN_CFLAGS], [-Wformat -Wformat-security])
  VXM_HARDEN_FORTIFY([VXM_HARDEN_CFLAGS], [CFLAGS])
  vxm_hardening="$VXM_HARDEN_CFLAGS"
  AC_LANG_PUSH([C++])
  m4_foreach_w([vxm_flag], [-fstack-protector-strong -fstack-clash-protection -fcf-protection -mbranch-protection=standard], [
    VXM_HARDEN_COMPILER([VXM_HARDEN_CXXFLAGS], vxm_flag, [CXXFLAGS])])
  VXM_HARDEN_COMPILER([VXM_HARDEN_CXXFLAGS], [-Wformat -Wformat-security], [CXXFLAGS])
  VXM_HARDEN_FORTIFY([VXM_HARDEN_CXXFLAGS], [CXXFLAGS])
  AC_LANG_POP([C++])
  VXM_HARDEN_LINKER([VXM_HARDEN_LDFLAGS], [-Wl,-z,relro])
  VXM_HARDEN_LINKER([VXM_HARDEN_LDFLAGS], [-Wl,-z,now])
  VXM_HARDEN_LINKER([VXM_HARDEN_LDFLAGS], [-Wl,-z,noexecstack])
  # libtool puts -fPIC behind what goes into libraries, so that this is for the programs alone.
  AC_MSG_CHECKING([for position-independent programs])
  vxm_saved_CFLAGS=$CFLAGS
  vxm_saved_LDFLAGS=$LDFLAGS
  CFLAGS="-fPIE $CFLAGS -Werror"
  LDFLAGS="-pie $LDFLAGS"
  AC_LINK_IFELSE([AC_LANG_PROGRAM([], [])],
    [vxm_taken=yes
     VXM_HARDEN_CFLAGS="$VXM_HARDEN_CFLAGS -fPIE"
     VXM_HARDEN_CXXFLAGS="$VXM_HARDEN_CXXFLAGS -fPIE"
     VXM_HARDEN_PIE_LDFLAGS=-pie], [vxm_taken=no])
  CFLAGS=$vxm_saved_CFLAGS
  LDFLAGS=$vxm_saved_LDFLAGS
  AC_MSG_RESULT([$vxm_taken])
  vxm_hardening=`AS_ECHO(["$vxm_hardening $VXM_HARDEN_LDFLAGS $VXM_HARDEN_PIE_LDFLAGS"]) | sed 's/-U_FORTIFY_SOURCE //;s/  */ /g;s/^ //;s/ $//'`])
AC_DEFINE_UNQUOTED([VXM_HARDENED_BY], ["$vxm_hardening"], [Hardening flags of this build.])
AC_SUBST([VXM_HARDEN_CFLAGS])
AC_SUBST([VXM_HARDEN_LDFLAGS])
AC_SUBST([VXM_HARDEN_PIE_LDFLAGS])
])
