# The tests: formats and linters first, then CTest and pytest. Sourced by the launcher.
# shellcheck shell=bash

run_all_tests() {
    begin_steps
    begin_results
    lint
    # The builds end the run when they fail: there is nothing to test then.
    with_lock build_both
    # One after another, while pytest runs: no processor waits for the last test of a step. Bench
    # counts instructions, which do not depend on other processes.
    ahead run_compiled_tests
    step 'pytest' run_all_pytests
    step 'CTest and bench' await
    step 'skipped tests' tell_skipped
    end_steps
}

run_compiled_tests() {
    local status=0 preset
    for preset in debug release; do run_ctest "$preset" || status=1; done
    run_quick_bench || status=1
    return "$status"
}

# Those of the whole program, which take longest, first.
run_all_pytests() {
    run_pytest --junitxml "$results/pytest.xml" --numprocesses "$processors" --dist loadfile \
        --no-loadscope-reorder --durations 25 tests post/tests
}

# Both builds at once: at its end each has parts that wait for one large file.
build_both() {
    local status=0
    (build debug all) &
    (build release all) || status=$?
    wait "$!" || status=$?
    if ((status != 0)); then exit "$status"; fi
}

# run_named_tests NAME...: the linters, CTests and pytests that one of the names is part of.
run_named_tests() {
    begin_steps
    begin_results
    lint "$@"
    run_named_ctests debug "$@"
    run_named_ctests release "$@"
    run_named_pytests "$@"
    if ((steps_tried == 0)); then
        fail 1 "no test has a name with '$(joined "' or '" "$@")' in it"
    fi
    if compgen -G "$results/*.xml" >/dev/null; then step 'skipped tests' tell_skipped; fi
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
    step "CTest, $preset build" run_ctest "$preset" --tests-regex "$pattern"
}

run_named_pytests() {
    local expression
    expression=$(joined ' or ' "$@")
    if run_pytest --collect-only -qq -k "$expression" >/dev/null; then
        step 'pytest' run_pytest --junitxml "$results/pytest.xml" -k "$expression"
    fi
}

# What CTest and pytest say of each test, as files of JUnit's form.
begin_results() {
    results=$root/build/tests
    rm -rf "$results"
    mkdir -p "$results"
}

tell_skipped() { "$venv_python" -I "$root/tools/skipped.py" "$results"; }

# run_ctest PRESET ARGUMENT...
run_ctest() {
    ctest --preset "$1" --output-junit "$results/CTest, $1 build.xml" "${@:2}"
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
