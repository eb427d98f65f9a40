// Bytes of files, and why they could not be written. Fortran's own files keep what was refused: their space
// on a full disk is not free again before the program ends.
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Open a file for writing from its beginning. What it holds already keeps its room on the disk until
// output_close. Gives 0, or the reason why not.
int output_open(const char* path, FILE** file) {
    const int descriptor = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    return *file == NULL ? errno : 0;
}

int output_put(FILE* file, const void* bytes, size_t n_bytes) {
    return fwrite(bytes, 1, n_bytes, file) == n_bytes ? 0 : errno;
}

// The file ends where the last byte was put. It is closed whatever happens.
int output_close(FILE* file) {
    int reason = fflush(file) == 0 ? 0 : errno;
    const off_t end = ftello(file);
    if (reason == 0 && ftruncate(fileno(file), end) != 0 && errno != EINVAL) reason = errno; // a device has no end
    if (fclose(file) != 0 && reason == 0) reason = errno;
    return reason;
}

// The reason in words, ended by a 0.
void output_reason(int reason, char* words, int size) {
    strncpy(words, strerror(reason), (size_t)size);
    words[size - 1] = 0;
}
