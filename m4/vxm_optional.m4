# SPDX-License-Identifier: BSD-3-Clause
# Optional packages, all asked for in the same way: --with-NAME=yes|no|check.

# VXM_OPTIONAL(NAME, UPPER, PURPOSE, DEBIAN-PACKAGE, TEST)
# TEST sets have_NAME=yes, UPPER_CFLAGS and UPPER_LIBS where the package is there.
# Gives HAVE_UPPER in config.h and in the makefiles, and have_NAME for what follows.
AC_DEFUN([VXM_OPTIONAL], [
AC_ARG_WITH([$1], [AS_HELP_STRING([--with-$1=yes|no|check], [$3 @<:@check@:>@])], [], [with_$1=check])
have_$1=no
AS_IF([test "x$with_$1" != xno], [
  $5
  AS_IF([test "x$with_$1 $have_$1" = "xyes no"],
    [AC_MSG_ERROR([$1 was asked for and not found (Debian: $4)])])])
AS_IF([test $have_$1 = yes], [AC_DEFINE([HAVE_$2], [1], [Define to 1 for $3.])])
AM_CONDITIONAL([HAVE_$2], [test $have_$1 = yes])
AC_SUBST([$2_CFLAGS])
AC_SUBST([$2_LIBS])
])

# VXM_OPTIONAL_CXX(NAME, UPPER, PURPOSE, DEBIAN-PACKAGE, CFLAGS, LIBS, INCLUDES, BODY)
# As VXM_OPTIONAL, for a C++17 package that brings no .pc file: INCLUDES and BODY have to compile and link.
AC_DEFUN([VXM_OPTIONAL_CXX], [
VXM_OPTIONAL([$1], [$2], [$3], [$4], [
  AS_IF([test $have_cxx = yes], [
    AC_MSG_CHECKING([for $1])
    AC_LANG_PUSH([C++])
    vxm_saved_CXXFLAGS=$CXXFLAGS
    vxm_saved_LIBS=$LIBS
    CXXFLAGS="$CXXFLAGS -std=gnu++17 $5"
    LIBS="$6 $LIBS"
    AC_LINK_IFELSE([AC_LANG_PROGRAM([$7], [$8])], [
      have_$1=yes
      $2_CFLAGS="$5"
      $2_LIBS="$6"])
    CXXFLAGS=$vxm_saved_CXXFLAGS
    LIBS=$vxm_saved_LIBS
    AC_LANG_POP([C++])
    AC_MSG_RESULT([$have_$1])])])
])
