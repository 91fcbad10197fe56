# SPDX-License-Identifier: BSD-3-Clause
# The manual page of one command, -v name=COMMAND, out of voxmend.1: its section there, whose comment is the summary,
# the options and exit status that all commands have in common, and the other pages.
function flush() {
  if (!in_command || has_options || $1 != ".TP")
    return
  print ".SH OPTIONS"
  has_options = 1
}
$1 == ".TH" {
  $2 = toupper("VOXMEND\\-" name)
  print ".\\\" Made from voxmend.1."
  print
  next
}
$1 == ".SS" {
  in_command = $3 == name
  if (in_command) {
    found = 1
    heading = $0
    sub(/^\.SS /, "", heading)
    getline summary
    sub(/^\.\\" /, "", summary)
    print ".SH NAME\nvoxmend\\-" name " \\- " summary
    print ".SH SYNOPSIS\n.B voxmend " name "\n" substr(heading, length("voxmend " name) + 2) (heading ~ /\[/ ? "" : " [OPTION]...")
    print ".SH DESCRIPTION"
  }
  next
}
$1 == ".SH" {
  in_command = 0
  in_common = ($0 == ".SH COMMON OPTIONS" && name != "binvox") || $0 == ".SH FILES" || $0 == ".SH EXIT STATUS"
}
in_command {
  flush()
  print
}
in_common {
  print
}
END {
  if (!found)
    exit 1
  print ".SH SEE ALSO\n.BR voxmend (1)\nhas all commands, and examples."
}
