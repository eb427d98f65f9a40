# Steps of a developer's commands, each of which is tried whatever became of those before it.
# Sourced by the launcher.
# shellcheck shell=bash

begin_steps() {
    failed_steps=()
    steps_tried=0
    cd "$root" || fail 1 "$root cannot be entered"
    processors=$(nproc) # asked before: it answers with OMP_NUM_THREADS where that is set
    # As in a run; and the compiled tests take no more of a processor than they are given.
    export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
}

# step NAME COMMAND...: run it, go on in any case, remember a failure.
step() {
    local name=$1 began=$SECONDS
    shift
    ((steps_tried += 1))
    printf '\n== %s\n' "$name"
    "$@" || failed_steps+=("$name")
    printf -- '-- %s: %d s\n' "$name" "$((SECONDS - began))"
}

# ahead COMMAND...: start it in the background; the step `await` reports it.
ahead() {
    ahead_log=$root/build/ahead.log
    mkdir -p "$root/build"
    set -m # a process group, which ends with this call
    "$@" >"$ahead_log" 2>&1 &
    set +m
    ahead_process=$!
    trap 'kill -- "-$ahead_process" 2>/dev/null' EXIT
}

# The status of the command in the background, and its output.
await() {
    local status
    wait "$ahead_process"
    status=$?
    trap - EXIT
    cat "$ahead_log"
    return "$status"
}

# What failed is the last line on stderr.
end_steps() {
    if ((${#failed_steps[@]} == 0)); then return; fi
    local list
    printf -v list ', %s' "${failed_steps[@]}"
    fail 1 "failed: ${list:2}"
}
