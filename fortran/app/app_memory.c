// Memory of the process, and what its environment says to libraries. A request that is refused must not be
// fatal without a word, nor be repeated for ever, as OpenBLAS does.
#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static _Noreturn void leave(const char* sentence) {
    const size_t length = strlen(sentence);
    _exit(write(STDERR_FILENO, sentence, length) == (ssize_t)length ? 1 : 2);
}

// End the program unless the system would give so many bytes of address space. Other threads may be at
// work, so nothing is tidied up.
static void require_address_space(int64_t n_bytes) {
    void* const place =
        mmap(NULL, (size_t)n_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (place == MAP_FAILED)
        leave("wingcrack: there is not enough memory for a run: allow this process at least 1 GB (ulimit -v), or "
              "fewer --threads\n");
    munmap(place, (size_t)n_bytes);
}

// All memory of the machine [byte].
double app_machine_memory(void) { return (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE); }

// OpenBLAS' own; absent where another BLAS is linked.
extern void openblas_set_num_threads(int n) __attribute__((weak));

// Of OpenMP's library; absent where no room has loops on threads.
extern void omp_set_num_threads(int n) __attribute__((weak));

// LAPACK. Called once, so that OpenBLAS takes the buffer that it keeps and uses from then on.
extern void dgesv_(const int* n, const int* n_rhs, double* a, const int* lda, int* pivots, double* b, const int* ldb,
                   int* info);

// What OpenBLAS takes for each thread beside the first: a buffer, a stack and a heap.
static const int64_t bytes_per_thread = (int64_t)208 << 20;

// What the smallest run takes beyond what the libraries have: a buffer of OpenBLAS, the heap's head room,
// gmsh.
static const int64_t bytes_of_run = (int64_t)256 << 20;

static int wanted_threads = 1;

// End the program if there is no memory for the smallest run. Else let OpenBLAS take its buffers. Dense
// blocks here are too small for threads, which would only wait for each other: there is one, unless the
// user has asked for more. Keep freed memory: factorizations ask for the same large blocks again and again.
void app_prepare_memory(void) {
    const int n = 1;
    double matrix = 1.0, solution = 1.0;
    int pivot, info;
    require_address_space(bytes_of_run + bytes_per_thread * (wanted_threads - 1));
    // Threads are for loops (add_room THREADS). Fronts are too small for those of OpenBLAS: measured, they
    // double the CPU time of factorizations and shorten nothing.
    if (openblas_set_num_threads) openblas_set_num_threads(1);
    if (omp_set_num_threads && getenv("OMP_NUM_THREADS") == NULL) omp_set_num_threads(wanted_threads);
    dgesv_(&n, &n, &matrix, &n, &pivot, &solution, &n, &info);
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_TOP_PAD, 64 * 1024 * 1024);
}

// Take what speaks to Fortran's library out of the environment: another order of bytes, units or lengths of
// lines would spoil the files.
static void forget_fortran(char** environment) {
    static const char prefix[] = "GFORTRAN_";
    char** kept = environment;
    for (; *environment != NULL; ++environment)
        if (strncmp(*environment, prefix, strlen(prefix)) != 0) *kept++ = *environment;
    *kept = NULL;
}

// Called by the loader before the libraries' own beginnings. OpenBLAS, and another one within gmsh, start
// as many threads as OPENBLAS_NUM_THREADS says, or else as there are processors, and look for memory for
// them for ever; so they begin with one each. Without that name the program begins again with it.
static void before_libraries(int argc, char** argv, char** environment) {
    static const char name[] = "OPENBLAS_NUM_THREADS=";
    static char one_thread[] = "OPENBLAS_NUM_THREADS=1";
    size_t n = 0;
    (void)argc;
    forget_fortran(environment);
    for (; environment[n] != NULL; ++n) {
        if (strncmp(environment[n], name, strlen(name)) != 0) continue;
        const long given = atol(environment[n] + strlen(name)), most = sysconf(_SC_NPROCESSORS_ONLN);
        wanted_threads = (int)(given > most ? most : given > 1 ? given : 1);
        environment[n] = one_thread;
        return;
    }
    char* longer[n + 2];
    memcpy(longer, environment, n * sizeof *longer);
    longer[n] = one_thread;
    longer[n + 1] = NULL;
    execve("/proc/self/exe", argv, longer); // returns only if that fails: then with as many as they like
}
__attribute__((section(".preinit_array"), used)) static void (*begin)(int, char**, char**) = before_libraries;

// What the linker puts in the place of malloc and its kin in our own code (CMakeLists.txt): Fortran's
// temporary arrays are used without a look whether there are any.
extern void* __real_malloc(size_t n);
extern void* __real_calloc(size_t n, size_t size);
extern void* __real_realloc(void* old, size_t n);

static void* given(void* place, size_t n) {
    if (place == NULL && n > 0)
        leave("wingcrack: there is not enough memory: give larger cells, or a machine with more of it\n");
    return place;
}

void* __wrap_malloc(size_t n) { return given(__real_malloc(n), n); }
void* __wrap_calloc(size_t n, size_t size) { return given(__real_calloc(n, size), n * size); }
void* __wrap_realloc(void* old, size_t n) { return given(__real_realloc(old, n), n); }
