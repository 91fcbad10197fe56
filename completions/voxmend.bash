# SPDX-License-Identifier: BSD-3-Clause
# Completion of voxmend and binvox for bash. What there is to choose from comes from the program itself: 'voxmend help --table'.

# Sets `row` to the line on an option: "--name", letter, argument and purpose, with tabs between.
_voxmend_find() {
  local line letter
  row=
  while IFS= read -r line; do
    letter=${line#*$'\t'}
    if [[ $1 == "${line%%$'\t'*}" || $1 == "${letter%%$'\t'*}" ]]; then
      row=$line
      return
    fi
  done <<<"$table"
}

# What the argument of the option in `row` can be: words that are given literally, or files.
_voxmend_values() {
  local argument=${row#*$'\t'*$'\t'} choices='' piece
  argument=${argument%%$'\t'*}
  case $argument in
  FILE* | GRID | MESH | DIR* | FOLDER*) return ;; # files, by the default of 'complete'
  esac
  compopt +o default +o bashdefault
  for piece in ${argument//|/ }; do
    [[ $piece =~ ^[a-z0-9][a-z0-9-]*$ ]] && choices+=" $piece"
    [[ $piece == FILE* ]] && compopt -o default
  done
  mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
}

# The options of binvox are behind one dash; the arguments are the program's words before them.
_voxmend_binvox() {
  if [[ $before == -t ]]; then
    mapfile -t COMPREPLY < <(compgen -W "binvox nrrd raw vtk schematic msh" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$@" -h 2>/dev/null | sed -n 's/^  \(-[a-z]*\) .*/\1/p')" -- "$word")
  fi
}

_binvox() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  _voxmend_binvox "$1"
}

_voxmend() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} table row i command=''
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    [[ ${COMP_WORDS[i]} == -* ]] && continue
    command=${COMP_WORDS[i]}
    break
  done
  if [[ -z $command ]]; then
    table=$("$1" help --table 2>/dev/null)
    mapfile -t COMPREPLY < <(compgen -W "--help --version $(cut -f 1 <<<"$table")" -- "$word")
    return
  fi
  if [[ $command == help && $word != -* ]]; then
    table=$("$1" help --table 2>/dev/null)
    mapfile -t COMPREPLY < <(compgen -W "$(cut -f 1 <<<"$table")" -- "$word")
    return
  fi
  if [[ $command == binvox ]]; then
    _voxmend_binvox "$1" binvox
    return
  fi
  table=$("$1" help --all "$command" 2>/dev/null) || return
  if [[ $word == = ]]; then # "--mode=" is three words to bash
    word=
  elif [[ $before == = ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  if [[ $before == -* && $word != -* ]]; then
    _voxmend_find "$before"
    if [[ -n $row && $row != *$'\t'*$'\t\t'* ]]; then
      _voxmend_values
      return
    fi
  fi
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(cut -f 1 <<<"$table")" -- "$word")
  elif [[ $command == combine ]]; then
    mapfile -t COMPREPLY < <(compgen -W "or and minus xor" -- "$word"; compgen -f -- "$word")
    compopt -o filenames
  fi
}

complete -o bashdefault -o default -F _voxmend voxmend
complete -o bashdefault -o default -F _binvox binvox
