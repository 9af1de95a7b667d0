/* Each of the steps below leaves a whole state from which the tables, still uncut, lead on. */
#include "adopt.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"

struct state_names {
    char *now, *before, *last;
};

static enum dm2_status remove_state(const char *path, struct dm2_error *err)
{
    if (unlink(path) != 0 && errno != ENOENT)
        return dm2_fail(err, DM2_IO, "%s: cannot remove it: %s", path, strerror(errno));
    return DM2_OK;
}

/* Copies a file of another name. The checkpoints that are there may be of later steps. */
static enum dm2_status copy_state(const struct state_names *names, const char *state, struct dm2_error *err)
{
    unsigned char *bytes = NULL;
    size_t n = 0;
    enum dm2_status status = file_read(state, SIZE_MAX / 4, &bytes, &n, err);
    if (status == DM2_OK)
        status = file_replace(names->now, bytes, n, err);
    if (status == DM2_OK)
        status = remove_state(names->before, err);
    free(bytes);
    return status;
}

static enum dm2_status take_name(const struct state_names *names, const char *state, struct dm2_error *err)
{
    const char *slash = strrchr(state, '/'), *base = slash == NULL ? state : slash + 1;
    enum dm2_status status = DM2_OK;
    if (strcmp(base, "checkpoint.dm2") == 0)
        return DM2_OK;
    if (strcmp(base, "checkpoint.prev.dm2") == 0)
        return file_rename(state, names->now, err);
    if (strcmp(base, "final.dm2") != 0)
        return copy_state(names, state, err);
    if (!file_is_absent(names->now))
        status = file_rename(names->now, names->before, err);
    return status == DM2_OK ? file_rename(state, names->now, err) : status;
}

enum dm2_status adopt_state(const char *directory, const char *state, bool ended, struct dm2_error *err)
{
    struct state_names names = {.now = text_join(directory, "/", "checkpoint.dm2"),
                                .before = text_join(directory, "/", "checkpoint.prev.dm2"),
                                .last = text_join(directory, "/", "final.dm2")};
    enum dm2_status status = names.now == NULL || names.before == NULL || names.last == NULL
                                 ? run_directory_no_memory(err)
                                 : DM2_OK;
    if (status == DM2_OK && !ended)
        status = take_name(&names, state, err);
    if (status == DM2_OK && !ended)
        status = remove_state(names.last, err);
    free(names.now);
    free(names.before);
    free(names.last);
    return status;
}
