# The tests: formats and linters first, then CTest and pytest. Sourced by the launcher.
# shellcheck shell=bash

run_all_tests() {
    begin_steps
    lint
    # The builds end the run when they fail: there is nothing to test then.
    with_lock build debug all
    with_lock build release all
    step 'CTest, debug build' ctest --preset debug -j "$processors"
    step 'CTest, release build' ctest --preset release -j "$processors"
    step 'pytest' run_pytest --numprocesses "$processors" --dist loadfile --durations 25
    # counts, which do not depend on what else the machine does
    step 'bench, the short form' run_quick_bench
    end_steps
}

# run_named_tests NAME...: the linters, CTests and pytests that one of the names is part of.
run_named_tests() {
    begin_steps
    lint "$@"
    run_named_ctests debug "$@"
    run_named_ctests release "$@"
    run_named_pytests "$@"
    if ((steps_tried == 0)); then
        fail 1 "no test has a name with '$(joined "' or '" "$@")' in it"
    fi
    end_steps
}

# CTest calls a test as CMake calls the program that it runs, so only what is asked for is built.
run_named_ctests() {
    local preset=$1 pattern tests
    pattern=$(joined '|' "${@:2}")
    with_lock configure "$preset"
    mapfile -t tests < <(ctest --test-dir "build/$preset" --show-only --tests-regex "$pattern" |
        sed -n 's/^ *Test *#[0-9]*: //p')
    if ((${#tests[@]} == 0)); then return; fi
    with_lock compile "$preset" "${tests[@]}"
    step "CTest, $preset build" \
        ctest --preset "$preset" -j "$processors" --tests-regex "$pattern"
}

run_named_pytests() {
    local expression
    expression=$(joined ' or ' "$@")
    if run_pytest --collect-only -qq -k "$expression" >/dev/null; then
        step 'pytest' run_pytest -k "$expression"
    fi
}

run_pytest() { "$venv_python" -P -m pytest "$@"; }

run_quick_bench() {
    "$venv_python" -I "$root/tools/start.py" bench --quick --out "$root/build/bench"
}

# joined SEPARATOR WORD...
joined() {
    local word all=$2
    for word in "${@:3}"; do all+=$1$word; done
    printf '%s' "$all"
}
