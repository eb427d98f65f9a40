// One process: nothing is shared (algebra_ranks.f90).
void algebra_begin_ranks(void) {}

int algebra_are_shared(int n) {
    (void)n;
    return 0;
}

int algebra_new_share(int n) {
    (void)n;
    return 0;
}

int algebra_communicator(int share) {
    (void)share;
    return 0; // MUMPS without MPI asks for none
}

void algebra_announce(int share, int kind, int job) {
    (void)share;
    (void)kind;
    (void)job;
}
