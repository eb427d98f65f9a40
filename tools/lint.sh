# Formats and linters, of every source in the tree. Sourced by the launcher.
# shellcheck shell=bash

readonly fortran_folders=(fortran verification/programs)
readonly cpp_folders=(cpp_mesh fortran)
readonly python_folders=(post tests tools verification)

# The steps, as "name|command"; the commands are functions below.
readonly linters=(
    'shellcheck|check_shell'
    'fprettify|check_fortran_format'
    'components|check_components'
    'call sequences|check_call_sequences'
    'fortitude|check_fortran'
    'clang-format|format_cpp --dry-run -Werror'
    'clang-tidy|check_cpp'
    'ruff check|check_python'
    'ruff format|format_python --check'
    'mypy|check_python_types'
)

# lint [NAME...]: all linters, or those that one of the names is part of.
lint() {
    local linter name words asked
    # on one processor, while the others run
    if (($# == 0)); then ahead check_python_types; fi
    for linter in "${linters[@]}"; do
        name=${linter%%|*}
        read -ra words <<<"${linter#*|}"
        if [[ $name == mypy ]] && (($# == 0)); then
            step "$name" await
        elif (($# == 0)); then
            step "$name" "${words[@]}"
        fi
        for asked; do
            if [[ $name == *"$asked"* ]]; then
                step "$name" "${words[@]}"
                break
            fi
        done
    done
}

format_sources() {
    step 'fprettify' format_fortran
    step 'clang-format' format_cpp -i
    step 'ruff format' format_python
}

check_shell() { "$venv/bin/shellcheck" --external-sources wingcrack .ci/run cmake/installed/setup.sh; }

# Fortran ----------------------------------------------------------------------------------------

# Settings: .fprettify.rc.
format_fortran() {
    find "${fortran_folders[@]}" -name '*.f90' -print0 | sort -z |
        xargs -0 -n 8 -P "$processors" "$venv_python" "$venv/bin/fprettify" "$@" 2>/dev/null
}

# fprettify exits with 0 whatever it finds: the difference that it prints is what counts.
check_fortran_format() {
    local difference status
    difference=$(format_fortran --diff)
    status=$?
    if [[ -n $difference ]]; then printf '%s\n' "$difference"; fi
    [[ -z $difference ]] && ((status == 0))
}

check_components() { "$venv_python" tools/components.py; }
check_call_sequences() { "$venv_python" tools/call_sequences.py; }

# Settings: fortitude.toml.
check_fortran() {
    "$venv_python" -m fortitude check --output-format concise "${fortran_folders[@]}"
}

# C++ --------------------------------------------------------------------------------------------

# Settings: .clang-format.
format_cpp() {
    find "${cpp_folders[@]}" \( -name '*.h' -o -name '*.hpp' -o -name '*.cpp' \) -print0 |
        xargs -0 "$venv_python" "$venv/bin/clang-format" "$@"
}

# Settings: .clang-tidy. The release build tells how each file is compiled.
check_cpp() {
    with_lock configure release
    find build/release/cpp_mesh fortran -name 'unity_*.cxx' -print0 -o -name '*.cpp' -print0 |
        xargs -0 -n 1 -P "$processors" "$venv_python" "$venv/bin/clang-tidy" --quiet -p build/release
}

# Python, settings: pyproject.toml ---------------------------------------------------------------

check_python() { "$venv_python" -m ruff check "${python_folders[@]}"; }

format_python() { "$venv_python" -m ruff format "$@" "${python_folders[@]}"; }

# One place at a time: mypy would take files of one name for one module. Those of the cases, many of
# one name, are modules of their folders.
check_python_types() {
    local place status=0
    for place in post tests tools; do
        "$venv_python" -m mypy --strict "$place" || status=1
    done
    MYPYPATH=. "$venv_python" -m mypy --strict verification/*/*.py || status=1
    return "$status"
}
