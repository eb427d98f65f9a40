// What the program needs of the operating system and Fortran has no word for.
#include <malloc.h>
#include <signal.h>

static volatile sig_atomic_t interrupt_count = 0, first_interrupt = 0;

static void note_interrupt(int number) {
    if (interrupt_count == 0) first_interrupt = number;
    // A terminal's Ctrl-C arrives twice, once through the launcher; a third one ends the program at once.
    interrupt_count = interrupt_count + 1;
    if (interrupt_count >= 2) signal(number, SIG_DFL);
}

// From now on the first two SIGINT or SIGTERM are noted instead of ending the program, and a file that grows
// beyond the user's limit is an error of writing, as on a full disk.
void app_catch_interrupts(void) {
    signal(SIGINT, note_interrupt);
    signal(SIGTERM, note_interrupt);
    signal(SIGXFSZ, SIG_IGN);
}

// The number of the first of them, or 0.
int app_interrupted(void) { return first_interrupt; }

// Keep freed memory: factorizations ask for the same large blocks again and again.
void app_keep_heap(void) {
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_TOP_PAD, 64 * 1024 * 1024);
}
