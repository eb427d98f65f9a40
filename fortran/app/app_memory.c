// Memory of the process, judged before anybody asks for it: OpenBLAS repeats a request that is refused
// for ever, and other libraries end without a word.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

// What OpenBLAS takes for each of its threads when it is loaded.
static const int64_t bytes_per_thread = (int64_t)144 << 20;

static const char threads_name[] = "OPENBLAS_NUM_THREADS=";
static const char too_little[] = "wingcrack: there is not enough memory to start: allow this process at least 1 GB "
                                 "(ulimit -v)\n";

// The system would give so many bytes of address space.
int app_has_address_space(int64_t n_bytes) {
    void* const place =
        mmap(NULL, (size_t)n_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (place == MAP_FAILED) return 0;
    munmap(place, (size_t)n_bytes);
    return 1;
}

// Bytes that the machine has free for this process, its limit (ulimit -v) included; -1: unknown.
int64_t app_available_memory(void) {
    int64_t available = -1;
    FILE* const file = fopen("/proc/meminfo", "r");
    if (file != NULL) {
        char line[200];
        long long kilobytes;
        while (fgets(line, sizeof line, file) != NULL)
            if (sscanf(line, "MemAvailable: %lld kB", &kilobytes) == 1) available = (int64_t)kilobytes * 1024;
        fclose(file);
    }
    struct rlimit limit;
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        (available < 0 || (int64_t)limit.rlim_cur < available))
        available = (int64_t)limit.rlim_cur;
    return available;
}

// BLAS. Called once, so that OpenBLAS takes the buffer that it keeps and uses from then on.
extern void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
                   const int*, const double*, const int*, const double*, double*, const int*, size_t, size_t);

void app_take_blas_buffer(void) {
    enum { n = 64 };
    static double a[n * n], b[n * n], c[n * n];
    const int size = n;
    const double one = 1.0, zero = 0.0;
    dgemm_("N", "N", &size, &size, &size, &one, a, &size, b, &size, &zero, c, &size, 1, 1);
}

// Begin again with one thread for BLAS: dense blocks here are too small for threads, which would only
// wait for each other. OpenBLAS looks at the environment when it is loaded, so it is set before.
static void begin_with_one_thread(char** argv, char** environment) {
    char path[4096];
    const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
    if (length <= 0) return;
    path[length] = '\0';
    size_t n = 0;
    while (environment[n] != NULL) ++n;
    char one_thread[] = "OPENBLAS_NUM_THREADS=1";
    char** const longer = malloc((n + 2) * sizeof *longer);
    if (longer == NULL) return;
    memcpy(longer, environment, n * sizeof *longer);
    longer[n] = one_thread;
    longer[n + 1] = NULL;
    execve(path, argv, longer);
    free(longer); // still here: with as many threads as OpenBLAS likes
}

// Before any library begins: how many threads has BLAS, and is there memory for them? A number that the
// user has asked for stays.
static void before_libraries(int argc, char** argv, char** environment) {
    (void)argc;
    const char* threads = NULL;
    for (char** entry = environment; *entry != NULL; ++entry)
        if (strncmp(*entry, threads_name, strlen(threads_name)) == 0) threads = *entry + strlen(threads_name);
    if (threads == NULL) begin_with_one_thread(argv, environment);
    const int n = threads == NULL ? 1 : atoi(threads);
    if (app_has_address_space(bytes_per_thread * (n > 1 ? n : 1))) return;
    if (write(STDERR_FILENO, too_little, strlen(too_little)) < 0) _exit(1);
    _exit(1);
}

// The loader calls what stands here before the libraries' own beginnings.
__attribute__((section(".preinit_array"), used)) static void (*begin)(int, char**, char**) = before_libraries;
