// Ranks by MPI (algebra_ranks.f90). MPI_COMM_WORLD is this file's; MUMPS makes communicators of its own
// from it, so messages here and there do not meet.
#include <mpi.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

// Unknowns from which on sharing a matrix pays (docs/scale.md).
static const int least_shared = 30000;

enum { tag = 1, words = 3 }; // share, kind, job
static const int job_end = 0;

static int n_shares = 0; // so far

// MUMPS on the ranks that do not run the program, until algebra_await says that there is no more.
extern void algebra_serve(void);

// mpiexec hands these two on to all ranks, but no SIGINT and no SIGTERM: the launcher sends them instead.
static void pass_on(int number) { kill(getpid(), number == SIGUSR1 ? SIGINT : SIGTERM); }

static void tell_all(const int message[words]) {
    int n;
    MPI_Comm_size(MPI_COMM_WORLD, &n);
    for (int rank = 1; rank < n; ++rank) MPI_Send(message, words, MPI_INT, rank, tag, MPI_COMM_WORLD);
}

// However the program ends, as long as it ends by itself; else mpiexec ends the other ranks.
static void end_ranks(void) {
    const int message[words] = {0, 0, job_end};
    tell_all(message);
    MPI_Finalize();
}

void algebra_begin_ranks(void) {
    int rank;
    sigset_t all, mask;
    prctl(PR_SET_PDEATHSIG, SIGKILL); // no rank stays behind if mpiexec is killed
    // Signals are for this thread, which keeps them waiting at times (algebra_metis.c): MPI's own threads
    // begin with this mask, and keep it.
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &mask);
    MPI_Init(NULL, NULL);
    pthread_sigmask(SIG_SETMASK, &mask, NULL);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank > 0) {
        // They end when the first one does, which has a state to write before.
        signal(SIGINT, SIG_IGN);
        signal(SIGTERM, SIG_IGN);
        signal(SIGUSR1, SIG_IGN);
        signal(SIGUSR2, SIG_IGN);
        algebra_serve();
        MPI_Finalize();
        _exit(0);
    }
    signal(SIGUSR1, pass_on);
    signal(SIGUSR2, pass_on);
    atexit(end_ranks);
}

int algebra_are_shared(int n) { return n >= least_shared; }

int algebra_new_share(int n) { return algebra_are_shared(n) ? ++n_shares : 0; }

int algebra_communicator(int share) { return (int)MPI_Comm_c2f(share == 0 ? MPI_COMM_SELF : MPI_COMM_WORLD); }

void algebra_announce(int share, int kind, int job) {
    const int message[words] = {share, kind, job};
    if (share != 0) tell_all(message);
}

// What the first rank announces next; 1, or 0 once there is no more. MPI waits by looking again and again,
// which would take a processor for as long as the first rank does anything else: so this sleeps in between.
int algebra_await(int* share, int* kind, int* job) {
    int message[words], is_there = 0;
    struct timespec pause = {.tv_sec = 0, .tv_nsec = 50000};
    const long longest = 2000000; // ns
    for (;;) {
        MPI_Iprobe(0, tag, MPI_COMM_WORLD, &is_there, MPI_STATUS_IGNORE);
        if (is_there) break;
        nanosleep(&pause, NULL);
        if (pause.tv_nsec < longest) pause.tv_nsec *= 2;
    }
    MPI_Recv(message, words, MPI_INT, 0, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    *share = message[0];
    *kind = message[1];
    *job = message[2];
    return *job != job_end;
}
