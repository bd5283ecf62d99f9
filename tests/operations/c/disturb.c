/* Counts the calls of a process that change the files below a folder, and at one of them kills it, or fills its disk.
 *
 * To be preloaded (LD_PRELOAD); does nothing until `disturb` is called.  Linux.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

enum { COUNT, KILL, FULL };

static char folder[4096];
static long at, count;
static int way = COUNT, told = -1, armed;

/* From now on: paths below `where` (no links in it) count; at the `n`-th call (from 1) the process is killed, or the
 * disk is full from then on.  Each call is told to the file descriptor `log`, unless that is -1. */
void disturb(const char *where, long n, int how, int log) {
    snprintf(folder, sizeof folder, "%s/", where);
    at = n, way = how, told = log;
    __atomic_store_n(&count, 0, __ATOMIC_SEQ_CST);
    armed = 1;
}

static int below(int fd, const char *path) {
    char whole[8192], name[64], place[4096];
    if (!armed) return 0;
    if (path && path[0] == '/')
        snprintf(whole, sizeof whole, "%s", path);
    else {
        ssize_t n = -1;
        if (fd == AT_FDCWD) {
            if (getcwd(place, sizeof place)) n = (ssize_t)strlen(place);
        } else {
            snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
            n = readlink(name, place, sizeof place - 1);
        }
        if (n < 0) return 0;
        place[n] = 0;
        if (path)
            snprintf(whole, sizeof whole, "%s/%s", place, path);
        else
            snprintf(whole, sizeof whole, "%s", place);
    }
    return strncmp(whole, folder, strlen(folder)) == 0;
}

#define REAL(type, name, ...) \
    static type (*real)(__VA_ARGS__); \
    if (!real) real = (type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, #name)

/* Whether the call must fail for want of room. */
static int counted(const char *call, int fd, const char *path, int takes_room) {
    if (!below(fd, path)) return 0;
    int before = errno;
    long n = __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST);
    if (told >= 0) {
        char line[8600], name[64], place[4096] = "";
        if (!path) {
            snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
            ssize_t length = readlink(name, place, sizeof place - 1);
            place[length < 0 ? 0 : length] = 0;
            path = place;
        }
        const char *last = strncmp(path, folder, strlen(folder)) ? path : path + strlen(folder);
        int length = snprintf(line, sizeof line, "%s %s\n", call, last);
        REAL(ssize_t, write, int, const void *, size_t);
        if (real(told, line, (size_t)length) < 0) abort();
    }
    if (way == KILL && n == at) {
        kill(getpid(), SIGKILL);
        for (;;) pause();
    }
    errno = before;
    if (way == FULL && n >= at && takes_room) {
        errno = ENOSPC;
        return 1;
    }
    return 0;
}

#define WRITING(type, name, args, fd, ...) \
    type name(__VA_ARGS__) { \
        REAL(type, name, __VA_ARGS__); \
        return counted(#name, fd, NULL, 1) ? (type)-1 : real args; \
    }
WRITING(ssize_t, write, (fd, data, n), fd, int fd, const void *data, size_t n)
WRITING(ssize_t, pwrite, (fd, data, n, to), fd, int fd, const void *data, size_t n, off_t to)
WRITING(ssize_t, pwrite64, (fd, data, n, to), fd, int fd, const void *data, size_t n, off64_t to)
WRITING(ssize_t, writev, (fd, parts, n), fd, int fd, const struct iovec *parts, int n)
WRITING(ssize_t, sendfile, (fd, from, to, n), fd, int fd, int from, off_t *to, size_t n)
WRITING(ssize_t, sendfile64, (fd, from, to, n), fd, int fd, int from, off64_t *to, size_t n)
WRITING(ssize_t, copy_file_range, (from, f, fd, t, n, how), fd, int from, off64_t *f, int fd, off64_t *t, size_t n,
        unsigned how)

#define PLAIN(name, args, fd, path, room, ...) \
    int name(__VA_ARGS__) { \
        REAL(int, name, __VA_ARGS__); \
        return counted(#name, fd, path, room) ? -1 : real args; \
    }
PLAIN(ftruncate, (fd, n), fd, NULL, 0, int fd, off_t n)
PLAIN(ftruncate64, (fd, n), fd, NULL, 0, int fd, off64_t n)
PLAIN(truncate, (path, n), AT_FDCWD, path, 0, const char *path, off_t n)
PLAIN(fsync, (fd), fd, NULL, 0, int fd)
PLAIN(fdatasync, (fd), fd, NULL, 0, int fd)
PLAIN(rename, (from, to), AT_FDCWD, to, 0, const char *from, const char *to)
PLAIN(renameat, (a, from, b, to), b, to, 0, int a, const char *from, int b, const char *to)
PLAIN(renameat2, (a, from, b, to, how), b, to, 0, int a, const char *from, int b, const char *to, unsigned how)
PLAIN(link, (from, to), AT_FDCWD, to, 1, const char *from, const char *to)
PLAIN(linkat, (a, from, b, to, how), b, to, 1, int a, const char *from, int b, const char *to, int how)
PLAIN(symlink, (from, to), AT_FDCWD, to, 1, const char *from, const char *to)
PLAIN(symlinkat, (from, fd, to), fd, to, 1, const char *from, int fd, const char *to)
PLAIN(unlink, (path), AT_FDCWD, path, 0, const char *path)
PLAIN(unlinkat, (fd, path, how), fd, path, 0, int fd, const char *path, int how)
PLAIN(rmdir, (path), AT_FDCWD, path, 0, const char *path)
PLAIN(mkdir, (path, mode), AT_FDCWD, path, 1, const char *path, mode_t mode)
PLAIN(mkdirat, (fd, path, mode), fd, path, 1, int fd, const char *path, mode_t mode)

#define OPENING(name, args, fd, ...) \
    int name(__VA_ARGS__, int flags, ...) { \
        REAL(int, name, __VA_ARGS__, int, ...); \
        va_list rest; \
        va_start(rest, flags); \
        mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0; \
        va_end(rest); \
        /* What is only read, or is there and is neither made nor emptied, changes nothing. */ \
        int changes = flags & O_TRUNC || (flags & O_CREAT && faccessat(fd, path, F_OK, 0)); \
        return changes && counted(#name, fd, path, flags & O_CREAT) ? -1 : real args; \
    }
OPENING(open, (path, flags, mode), AT_FDCWD, const char *path)
OPENING(open64, (path, flags, mode), AT_FDCWD, const char *path)
OPENING(openat, (fd, path, flags, mode), fd, int fd, const char *path)
OPENING(openat64, (fd, path, flags, mode), fd, int fd, const char *path)
