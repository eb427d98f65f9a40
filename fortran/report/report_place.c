// What a run asks the system about its folder.
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

// Both paths lead to one file, whatever links they take.
int output_same_file(const char* a, const char* b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

// The process that holds a lock on a file, as the kernel lists it; 0: it does not say.
static int holder_of(int descriptor) {
    struct stat status;
    FILE* const locks = fopen("/proc/locks", "r");
    int holder = 0;
    if (locks == NULL) return 0;
    if (fstat(descriptor, &status) == 0) {
        char line[200];
        int process;
        unsigned long long inode;
        while (fgets(line, sizeof line, locks) != NULL)
            if (sscanf(line, "%*s FLOCK %*s %*s %d %*x:%*x:%llu", &process, &inode) == 2 &&
                inode == (unsigned long long)status.st_ino)
                holder = process;
    }
    fclose(locks);
    return holder;
}

// Hold a folder against other runs until output_release_folder or the end of the process, however that
// comes. Gives a descriptor; or -1: another run holds it, and that is process `holder` (0: unknown);
// or -2: the file system knows no locks.
int output_hold_folder(const char* path, int* holder) {
    const int descriptor = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    *holder = 0;
    if (descriptor < 0) return -2;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
    const int result = errno == EWOULDBLOCK ? -1 : -2;
    if (result == -1) *holder = holder_of(descriptor);
    close(descriptor);
    return result;
}

// The path still leads to the folder that is held; where there are no locks, to some folder.
int output_is_folder(const char* path, int descriptor) {
    struct stat now, held;
    if (stat(path, &now) != 0) return 0;
    if (descriptor < 0) return 1;
    return fstat(descriptor, &held) == 0 && now.st_dev == held.st_dev && now.st_ino == held.st_ino;
}

void output_release_folder(int descriptor) { close(descriptor); }
