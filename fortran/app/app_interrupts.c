// Signals that ask the program to end.
//
// They are blocked everywhere, and a thread of their own waits for them: handlers would not stay. METIS sets its
// own around each call, and sets those before back as ones that are gone after their first signal.
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <time.h>

static atomic_int first_signal = 0;

// One wish to end may arrive several times: a terminal's Ctrl-C, or a signal of `timeout`, comes directly and
// through the launcher, which may be late on a busy machine.
static const double same_wish = 1.0; // s

static sigset_t wishes(void) {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    return signals;
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Note the first signal; a second wish ends the program at once.
static void *wait_for_signals(void *nothing) {
    const sigset_t signals = wishes();
    double first_time = 0.0;
    for (;;) {
        int number;
        if (sigwait(&signals, &number) != 0) {
            continue;
        }
        if (first_signal == 0) {
            first_time = seconds();
            first_signal = number;
        } else if (seconds() - first_time > same_wish) {
            signal(number, SIG_DFL);
            raise(number); // is delivered once it is not blocked any more
            pthread_sigmask(SIG_UNBLOCK, &signals, NULL);
        }
    }
    return nothing;
}

// From now on the first SIGINT or SIGTERM is noted, and a second one ends the program at once. A file
// that grows beyond the user's limit is an error of writing, as on a full disk. To be called before there are
// other threads.
void app_catch_interrupts(void) {
    const sigset_t signals = wishes();
    pthread_t waiting;
    signal(SIGXFSZ, SIG_IGN);
    pthread_sigmask(SIG_BLOCK, &signals, NULL);
    if (pthread_create(&waiting, NULL, wait_for_signals, NULL) == 0) {
        pthread_detach(waiting);
    } else {
        pthread_sigmask(SIG_UNBLOCK, &signals, NULL); // they end the program, then
    }
}

// The number of the signal, or 0.
int app_interrupted(void) { return first_signal; }
