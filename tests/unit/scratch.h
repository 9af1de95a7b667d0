/* A directory of one test below TMPDIR, created at its begin and removed at its end. */
#ifndef DM2_TESTS_SCRATCH_H
#define DM2_TESTS_SCRATCH_H

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char scratch_directory[512];

static inline void scratch_begin(void)
{
    const char *base = getenv("TMPDIR");
    snprintf(scratch_directory, sizeof scratch_directory, "%s/dm2-test-XXXXXX", base == NULL ? "/tmp" : base);
    if (mkdtemp(scratch_directory) == NULL) {
        perror(scratch_directory);
        exit(1);
    }
}

/* The path of a name in the scratch directory, valid until the fourth next call. */
static inline const char *scratch_path(const char *name)
{
    static char paths[4][800];
    static int next;
    if (scratch_directory[0] == '\0') {
        fprintf(stderr, "%s: no scratch_begin\n", name);
        exit(1);
    }
    char *path = paths[next = (next + 1) % 4];
    snprintf(path, sizeof paths[0], "%s/%s", scratch_directory, name);
    return path;
}

static inline void scratch_remove(const char *path)
{
    struct stat info;
    if (lstat(path, &info) != 0)
        return;
    if (S_ISDIR(info.st_mode)) {
        DIR *dir = opendir(path);
        const struct dirent *entry;
        while (dir != NULL && (entry = readdir(dir)) != NULL) {
            size_t size = strlen(path) + strlen(entry->d_name) + 2;
            char *below = malloc(size);
            if (below == NULL)
                exit(1);
            snprintf(below, size, "%s/%s", path, entry->d_name);
            if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
                scratch_remove(below);
            free(below);
        }
        if (dir != NULL)
            closedir(dir);
    }
    remove(path);
}

static inline void scratch_end(void)
{
    scratch_remove(scratch_directory);
}

static inline bool scratch_exists(const char *name)
{
    struct stat info;
    return lstat(scratch_path(name), &info) == 0;
}

static inline void scratch_write(const char *name, const char *text)
{
    FILE *f = fopen(scratch_path(name), "w");
    if (f == NULL || fputs(text, f) < 0 || fclose(f) != 0) {
        perror(name);
        exit(1);
    }
}

/* The whole file as a malloc'd text that the caller frees; *length may be NULL. */
static inline char *scratch_read(const char *name, size_t *length)
{
    FILE *f = fopen(scratch_path(name), "rb");
    if (f == NULL) {
        perror(name);
        exit(1);
    }
    size_t n = 0, cap = 1 << 16;
    char *text = malloc(cap);
    for (size_t got; text != NULL && (got = fread(text + n, 1, cap - n - 1, f)) > 0;) {
        n += got;
        if (cap - n < 2)
            text = realloc(text, cap *= 2);
    }
    fclose(f);
    if (text == NULL)
        exit(1);
    text[n] = '\0';
    if (length != NULL)
        *length = n;
    return text;
}

#endif
