// Signals that ask the program to end.
#include <signal.h>
#include <string.h>
#include <time.h>

static volatile sig_atomic_t first_signal = 0;
static struct timespec first_time;

// One wish to end may arrive several times: a terminal's Ctrl-C comes directly and through the launcher.
static const double same_wish = 0.3; // s

static void note_signal(int number) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (first_signal == 0) {
        first_time = now;
        first_signal = number;
    } else if ((double)(now.tv_sec - first_time.tv_sec) + 1e-9 * (double)(now.tv_nsec - first_time.tv_nsec) >
               same_wish) {
        signal(number, SIG_DFL);
        raise(number); // is delivered when this function returns
    }
}

// From now on the first SIGINT or SIGTERM is noted, and a second one ends the program at once. A file
// that grows beyond the user's limit is an error of writing, as on a full disk.
void app_catch_interrupts(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = note_signal;
    action.sa_flags = SA_RESTART;
    // Neither interrupts the handling of the other.
    sigaddset(&action.sa_mask, SIGINT);
    sigaddset(&action.sa_mask, SIGTERM);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN);
}

// The number of the signal, or 0.
int app_interrupted(void) { return first_signal; }
