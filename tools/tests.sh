# The tests: formats and linters first, then CTest and pytest. Sourced by the launcher.

# step NAME COMMAND...: run it, go on in any case, remember a failure.
step() {
    local name=$1
    shift
    printf '\n== %s\n' "$name"
    "$@" || failed_steps+=("$name")
}

run_tests() {
    failed_steps=()
    cd "$root" || return 1
    export OPENBLAS_NUM_THREADS=1
    local python_folders=(post tests)

    step 'shell syntax' shell_syntax
    step 'fprettify' fortran_format
    step 'rooms' "$venv_python" tools/rooms.py
    step 'fortitude' "$venv_python" -m fortitude check --output-format concise fortran
    step 'clang-format' cpp_format
    step 'ruff check' "$venv_python" -m ruff check "${python_folders[@]}"
    step 'ruff format' "$venv_python" -m ruff format --check "${python_folders[@]}"
    # One at a time: both have a conftest.py, which mypy takes for one module.
    local folder
    for folder in "${python_folders[@]}"; do
        step "mypy $folder" "$venv_python" -m mypy --strict "$folder"
    done

    # The builds end the run when they fail: there is nothing to test then.
    with_lock build debug all
    with_lock build release all
    step 'CTest, debug build' ctest --preset debug -j "$(nproc)"
    step 'CTest, release build' ctest --preset release -j "$(nproc)"
    step 'pytest' "$venv_python" -m pytest

    if ((${#failed_steps[@]} > 0)); then
        local list
        printf -v list ', %s' "${failed_steps[@]}"
        fail 1 "failed: ${list:2}"
    fi
}

shell_syntax() {
    local file status=0
    for file in wingcrack .ci/run tools/*.sh; do bash -n "$file" || status=1; done
    return "$status"
}

# fprettify exits with 0 whatever it finds: the difference that it prints is what counts.
# Settings: .fprettify.rc.
fortran_format() {
    local difference status
    difference=$(find fortran -name '*.f90' -print0 | sort -z |
        xargs -0 -n 8 -P "$(nproc)" "$venv_python" "$venv/bin/fprettify" --diff 2>/dev/null)
    status=$?
    if [[ -n $difference ]]; then printf '%s\n' "$difference"; fi
    [[ -z $difference ]] && ((status == 0))
}

# Settings: .clang-format.
cpp_format() {
    find cpp_mesh fortran \( -name '*.h' -o -name '*.hpp' -o -name '*.cpp' \) -print0 |
        xargs -0 "$venv_python" "$venv/bin/clang-format" --dry-run -Werror
}
