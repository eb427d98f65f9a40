// What a path leads to, and a hold on a folder.
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

// Numbers of base_paths.f90.
enum { path_nothing, path_file, path_folder, path_pipe, path_device, path_unreachable };

int base_path_kind(const char* path) {
    struct stat status;
    if (stat(path, &status) != 0)
        return errno == ENOENT || errno == ENOTDIR ? path_nothing : path_unreachable;
    if (S_ISREG(status.st_mode)) return path_file;
    if (S_ISDIR(status.st_mode)) return path_folder;
    if (S_ISFIFO(status.st_mode)) return path_pipe;
    return path_device;
}

// Both paths lead to one file, whatever links they take.
int base_same_file(const char* a, const char* b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

// Take a hold on a folder, which ends with base_release_folder or with the process. Gives a number for
// the former; -1: another process or call has it; -2: the file system knows no holds.
int base_hold_folder(const char* path) {
    const int descriptor = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return -2;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
    const int result = errno == EWOULDBLOCK ? -1 : -2;
    close(descriptor);
    return result;
}

void base_release_folder(int descriptor) { close(descriptor); }

// Write a text to standard output; 0, or the number of the system's error.
int base_write_standard_output(const char* text, long n) {
    while (n > 0) {
        const ssize_t taken = write(STDOUT_FILENO, text, (size_t)n);
        if (taken < 0 && errno == EINTR) continue;
        if (taken < 0) return errno;
        text += taken;
        n -= taken;
    }
    return 0;
}

// The system's words for an error, of at most n characters; gives how many there are.
int base_error_words(int number, char* words, int n) {
    const char* text = strerror(number);
    int length = 0;
    while (length < n && text[length] != '\0') {
        words[length] = text[length];
        ++length;
    }
    return length;
}
