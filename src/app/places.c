/* The place of the running program comes from argv[0], because POSIX has no other way to ask for it: a name
 * without a slash was found on PATH, and readlink follows links of the program. The system follows links of
 * folders, also before "..". The Makefile compiles PREFIX in. */
#include "places.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"

#ifndef DM2_SHARE
#define DM2_SHARE "/usr/local/share/dm2"
#endif

/* The first `n` bytes of `a`, then `b`. malloc'd; NULL: no memory. */
static char *joined(const char *a, size_t n, const char *b)
{
    size_t length = strlen(b) + 1;
    char *path = mem_alloc(n + length, 1);
    if (path == NULL)
        return NULL;
    memcpy(path, a, n);
    memcpy(path + n, b, length);
    return path;
}

/* The length of a path up to its last slash, with the slash; 0: the path has none. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL ? 0 : (size_t)(slash - path) + 1;
}

/* The path of the running program, as given or found on PATH; NULL: it is not found, or no memory. */
static char *running_program(const char *argv0)
{
    if (strchr(argv0, '/') != NULL)
        return joined(argv0, strlen(argv0), "");
    const char *list = getenv("PATH");
    for (const char *at = list; at != NULL && *at != '\0';) {
        size_t n = strcspn(at, ":");
        char *folder = n == 0 ? joined(".", 1, "/") : joined(at, n, "/");
        char *path = folder == NULL ? NULL : joined(folder, strlen(folder), argv0);
        free(folder);
        if (path == NULL || access(path, X_OK) == 0)
            return path;
        free(path);
        at += n + (at[n] == ':');
    }
    return NULL;
}

/* The program `name` in the folder of `path`; NULL: there is none, or no memory. */
static char *program_beside(const char *path, const char *name)
{
    char *beside = path == NULL ? NULL : joined(path, folder_length(path), name);
    if (beside != NULL && access(beside, X_OK) == 0)
        return beside;
    free(beside);
    return NULL;
}

char *places_program(const char *argv0, const char *name)
{
    char *program = running_program(argv0);
    char *found = program_beside(program, name);
    program = file_follow_links(program);
    if (found == NULL)
        found = program_beside(program, name);
    free(program);
    return found != NULL ? found : joined(name, strlen(name), "");
}

/* Adds the first n bytes of `folder` and `tail`, once; n = 0: nothing. */
static enum dm2_status add_root(struct deck_roots *roots, const char *folder, size_t n, const char *tail,
                                struct dm2_error *err)
{
    for (size_t k = 0; k < roots->n; k++)
        if (strncmp(roots->items[k], folder, n) == 0 && strcmp(roots->items[k] + n, tail) == 0)
            return DM2_OK;
    if (n == 0)
        return DM2_OK;
    char **grown = realloc(roots->items, (roots->n + 1) * sizeof *grown);
    if (grown != NULL)
        roots->items = grown;
    char *root = grown == NULL ? NULL : joined(folder, n, tail);
    if (root == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the places of included files");
    roots->items[roots->n++] = root;
    return DM2_OK;
}

enum dm2_status places_roots(const char *argv0, struct deck_roots *out, struct dm2_error *err)
{
    static const char share[] = DM2_SHARE;
    static const char *const beside[] = {"../share/dm2", "../share/dm2/input", "../input"};
    enum dm2_status status = DM2_OK;
    *out = (struct deck_roots){0};
    for (const char *at = getenv("DM2_PATH"); at != NULL && *at != '\0' && status == DM2_OK;) {
        size_t n = strcspn(at, ":");
        status = add_root(out, at, n, "", err);
        at += n + (at[n] == ':');
    }
    if (status == DM2_OK)
        status = add_root(out, share, sizeof share - 1, "", err);
    if (status == DM2_OK)
        status = add_root(out, share, sizeof share - 1, "/input", err);
    char *program = file_follow_links(running_program(argv0));
    for (size_t k = 0; k < sizeof beside / sizeof beside[0] && program != NULL && status == DM2_OK; k++)
        status = add_root(out, program, folder_length(program), beside[k], err);
    free(program);
    return status;
}

void places_free_roots(struct deck_roots *roots)
{
    for (size_t k = 0; k < roots->n; k++)
        free(roots->items[k]);
    free(roots->items);
    *roots = (struct deck_roots){0};
}
