# SPDX-License-Identifier: BSD-3-Clause
# Completion of voxmend for fish. What there is to choose from comes from the program itself: 'voxmend help --table'.

# The command of the line that is being typed, if it is there already.
function __voxmend_command
    set -l words (commandline -opc)
    if test (count $words) -ge 2
        echo $words[2]
    end
end

function __voxmend_commands
    set -l words (commandline -opc)
    command $words[1] help --table 2>/dev/null
end

# The options of the command, with what they are for.
function __voxmend_options
    set -l words (commandline -opc)
    for line in (command $words[1] help --all $words[2] 2>/dev/null)
        set -l fields (string split \t -- $line)
        echo $fields[1]\t$fields[4]
        test -n "$fields[2]"; and echo $fields[2]\t$fields[4]
    end
end

# What the option before the cursor takes: 'files', words to choose from, or nothing.
function __voxmend_argument
    set -l words (commandline -opc)
    test (count $words) -ge 3; or return 1
    for line in (command $words[1] help --all $words[2] 2>/dev/null)
        set -l fields (string split \t -- $line)
        if test -n "$fields[3]"; and contains -- $words[-1] $fields[1] $fields[2]
            echo $fields[3]
            return 0
        end
    end
    return 1
end

function __voxmend_values
    for piece in (string split '|' -- (__voxmend_argument))
        string match -rq '^[a-z0-9][a-z0-9-]*$' -- $piece; and echo $piece
    end
end

function __voxmend_is_file
    string match -rq '^(FILE|GRID|MESH|DIR|FOLDER)' -- (__voxmend_argument)
end

complete -c voxmend -f -n 'test -z "$(__voxmend_command)"' -a '(__voxmend_commands)'
complete -c voxmend -f -n 'test -z "$(__voxmend_command)"' -l help -d 'show the commands'
complete -c voxmend -f -n 'test -z "$(__voxmend_command)"' -l version -d 'show the version'
complete -c voxmend -f -n 'test "$(__voxmend_command)" = help' -a '(__voxmend_commands)'
complete -c voxmend -f -n '__voxmend_argument >/dev/null; and not __voxmend_is_file' -a '(__voxmend_values)'
complete -c voxmend -F -n '__voxmend_is_file'
complete -c voxmend -n 'test -n "$(__voxmend_command)"; and not __voxmend_argument >/dev/null; and string match -q -- "-*" (commandline -ct)' -a '(__voxmend_options)'
