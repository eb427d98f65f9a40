// METIS takes SIGTERM and SIGABRT for its own while it orders, and comes back with a fault if one
// arrives: signals wait until it has given them back.
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>

extern int METIS_NodeND(int32_t* n, int32_t* first, int32_t* item, int32_t* weight, int32_t* options, int32_t* order,
                        int32_t* place);

// METIS_NodeND without weights (manual of METIS 5.1, section 5.7), which signals do not disturb.
int algebra_node_nd(int32_t n, int32_t* first, int32_t* item, int32_t* options, int32_t* order, int32_t* place) {
    sigset_t all, mask;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &mask);
    const int status = METIS_NodeND(&n, first, item, NULL, options, order, place);
    pthread_sigmask(SIG_SETMASK, &mask, NULL);
    return status;
}
