# What the launcher hands over to: the solver and the Python packages. Sourced by the launcher.
# shellcheck shell=bash

# solve THREADS ARGUMENT...: call the solver, with as many threads, which do not keep a core busy
# while they wait.
solve() {
    local status lacking
    OPENBLAS_NUM_THREADS=$1 OMP_NUM_THREADS=$1 OMP_WAIT_POLICY=passive supervise "$solver" "${@:2}"
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

# solve_on RANKS THREADS ARGUMENT...: the same with so many processes that share large matrices.
solve_on() {
    if (($1 == 1)); then
        solve "${@:2}"
        return
    fi
    # A session of their own: of signals, mpiexec takes SIGINT and SIGTERM for its own business, and
    # hands on two others (algebra_ranks.c).
    local mpiexec=(setsid mpiexec.openmpi --quiet --oversubscribe --bind-to none
        --mca mpi_yield_when_idle 1 --mca btl_vader_single_copy_mechanism none)
    local status sent_for_int=USR1 sent_for_term=USR2
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 # as everything else here
    OPENBLAS_NUM_THREADS=$2 OMP_NUM_THREADS=$2 OMP_WAIT_POLICY=passive \
        supervise "${mpiexec[@]}" -n "$1" "$ranks_solver" "${@:3}" </dev/null
    status=$?
    case $status in
        $((128 + $(kill -l USR1)))) return 130 ;; # before the ranks knew of them
        $((128 + $(kill -l USR2)))) return 143 ;;
        130 | 143) ;;
        1[3-9][0-9])
            say "signal $((status - 128)) has ended a rank, which may be for want of memory;" \
                'the last state written before that is on disk'
            ;;
    esac
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
    local sent=$1
    signalled=$1
    case $1 in
        INT) sent=${sent_for_int:-INT} ;;
        TERM) sent=${sent_for_term:-TERM} ;;
    esac
    if [[ -n $child ]]; then kill "-$sent" "$child" 2>/dev/null; fi
}
