/* A library that is loaded before the system's, and makes calls on files below the folder SHIM_FOLDER fail or lie, each
 * with the probability that its variable gives. SHIM_SEED decides which. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static double variable(const char *name) {
    const char *text = getenv(name);
    return text ? atof(text) : 0;
}

/* In [0, 1), from the seed and the number of the call. */
static double next_random(void) {
    static uint64_t calls;
    uint64_t x = (uint64_t)variable("SHIM_SEED") + 0x9e3779b97f4a7c15 * (1 + __atomic_fetch_add(&calls, 1, __ATOMIC_RELAXED));
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return (double)((x ^ (x >> 31)) >> 11) / 9007199254740992.0;
}

static int happens(const char *name) {
    double probability = variable(name);
    return probability > 0 && next_random() < probability;
}

static int concerns(int fd) {
    char link[64], path[4096];
    const char *folder = getenv("SHIM_FOLDER");
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, path, sizeof path - 1);
    if (!folder || length <= 0) return 0;
    path[length] = 0;
    return strstr(path, folder) != 0;
}

static int fails(void) {
    static const int errors[] = {EIO, ENOSPC, EDQUOT, ESTALE, EMFILE};
    errno = errors[(int)(5 * next_random())];
    return -1;
}

ssize_t write(int fd, const void *bytes, size_t count) {
    if (concerns(fd)) {
        if (happens("SHIM_FAIL")) return fails();
        if (happens("SHIM_EINTR")) return errno = EINTR, -1;
        if (happens("SHIM_LIE")) return count;
        if (count > 1 && happens("SHIM_SHORT")) count = 1 + (size_t)(next_random() * (count - 1));
    }
    return NEXT(write)(fd, bytes, count);
}

ssize_t read(int fd, void *bytes, size_t count) {
    int concerned = concerns(fd);
    if (concerned && happens("SHIM_FAIL")) return fails();
    if (concerned && happens("SHIM_EINTR")) return errno = EINTR, -1;
    ssize_t got = NEXT(read)(fd, bytes, count);
    if (concerned && got > 0 && happens("SHIM_FLIP")) ((char *)bytes)[(size_t)(next_random() * got)] ^= 4;
    return got;
}

int fsync(int fd) { return concerns(fd) && happens("SHIM_FAIL") ? fails() : NEXT(fsync)(fd); }

int ftruncate64(int fd, off64_t length) {
    return concerns(fd) && happens("SHIM_FAIL") ? fails() : NEXT(ftruncate64)(fd, length);
}

int flock(int fd, int operation) {
    if (concerns(fd) && happens("SHIM_NO_LOCKS")) return errno = ENOLCK, -1;
    return NEXT(flock)(fd, operation);
}

int renameat(int from_folder, const char *from, int to_folder, const char *to) {
    if (concerns(from_folder)) {
        if (happens("SHIM_FAIL")) return fails();
        if (happens("SHIM_LIE")) return 0;
    }
    int done = NEXT(renameat)(from_folder, from, to_folder, to);
    /* A network file system that asks again after a lost answer. */
    if (concerns(from_folder) && happens("SHIM_RETRY")) return errno = ENOENT, -1;
    return done;
}

int unlinkat(int folder, const char *name, int flags) {
    return concerns(folder) && happens("SHIM_FAIL") ? fails() : NEXT(unlinkat)(folder, name, flags);
}
