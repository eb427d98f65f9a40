# What the launcher hands over to: the solver and the Python packages. Sourced by the launcher.
# shellcheck shell=bash

# solve THREADS ARGUMENT...: call the solver, with as many threads of its loops and of the dense
# linear algebra.
solve() {
    local status lacking
    OPENBLAS_NUM_THREADS=$1 OMP_NUM_THREADS=$1 supervise "$solver" "${@:2}"
    status=$?
    if ((status == 127)); then
        lacking=$(ldd "$solver" 2>/dev/null | sed -n 's/^[[:space:]]*\(.*\) => not found$/\1/p')
        if [[ -z $lacking ]]; then
            fail 1 'there is not enough memory to start: allow this process at least 1 GB (ulimit -v)'
        fi
        fail "$exit_environment" "the solver cannot start without ${lacking//$'\n'/, };" \
            "remove the folders $venv and $root/build and call again, which installs and builds anew"
    fi
    return "$status"
}

# start PACKAGE ARGUMENT...: run a Python package of post/. matplotlib keeps its list of fonts with
# the environment: one in the user's home may name what is no longer there.
start() {
    hold_python
    MPLCONFIGDIR=$venv/matplotlib supervise "$venv_python" -I "$root/tools/start.py" "$@"
}

# ask PACKAGE ARGUMENT...: let a package understand its arguments, whatever Python there is.
ask() {
    local python=$venv_python
    if [[ ! -x $python ]]; then python=python3; fi
    "$python" -I "$root/tools/start.py" --ask "$@"
}

# understand PACKAGE ARGUMENT...: end with a reason if the package cannot understand its arguments.
# This comes before anything is installed or built; without a Python that can say, it comes later.
understand() {
    if [[ ! -x $venv_python ]] && ! has_command python3; then return; fi
    ask "$@"
    if (($? == exit_usage)); then exit "$exit_usage"; fi
}

# A signal ends the launcher with the status that is promised for it.
end_on_signals() {
    trap 'exit 130' INT
    trap 'exit 143' TERM
}

# Run a command beside this shell so that a signal sent to the launcher alone reaches it too, and
# return its exit status. The subshell undoes bash's habit of shielding such a command from ctrl-C.
supervise() {
    local status='' waited signalled='' child=''
    trap 'forward INT' INT
    trap 'forward TERM' TERM
    (
        trap - INT TERM QUIT
        exec "$@"
    ) <&0 &
    child=$!
    if [[ -n $signalled ]]; then forward "$signalled"; fi # it came before there was a child
    while :; do
        signalled=
        wait "$child"
        waited=$?
        # 127 in a later round: the child's status was already collected in the one before
        if [[ -z $status ]] || ((waited != 127)); then status=$waited; fi
        if [[ -z $signalled ]]; then break; fi
    done
    end_on_signals
    return "$status"
}

# forward SIGNAL: hand a signal on to the command that `supervise` runs.
forward() {
    signalled=$1
    if [[ -n $child ]]; then kill "-$1" "$child" 2>/dev/null; fi
}
