/* The schedule does not determine at which steps links break, so that a missing row cannot be noticed when a
 * run continues; the rows that are there must ascend. */
#include "cracks.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/number.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"

const char cracks_table[] = "cracks.csv";

static const char heading[] = "step,time [us],x [cm],y [cm],id_a,id_b,grains,mode,energy [g cm2/us2]\n";

/* --- rows --- */

void cracks_put_heading(struct file_out *f)
{
    file_puts(f, heading);
}

enum dm2_status cracks_put(struct file_out *f, const struct config *c, int64_t step, struct crack_list *list,
                           struct dm2_error *err)
{
    static const char *const modes[CRACK_MODES] = {
        [CRACK_PULLED] = "pulled", [CRACK_YIELDED] = "yielded", [CRACK_SHEARED] = "sheared"};
    char time[NUMBER_TEXT_MAX + 1], x[NUMBER_TEXT_MAX + 1], y[NUMBER_TEXT_MAX + 1],
        energy[NUMBER_TEXT_MAX + 1];
    crack_list_sort(list);
    time[number_format(config_time(c, step), time)] = '\0';
    for (size_t k = 0; k < list->n; k++) {
        const struct crack *crack = &list->items[k];
        x[number_format(crack->r[0], x)] = '\0';
        y[number_format(crack->r[1], y)] = '\0';
        energy[number_format(crack->energy, energy)] = '\0';
        file_printf(f, "%" PRId64 ",%s,%s,%s,%" PRIu32 ",%" PRIu32 ",%d,%s,%s\n", step, time, x, y,
                    crack->id_a, crack->id_b, crack->grains, modes[crack->mode], energy);
    }
    return file_flush(f, err);
}

/* --- a run that continues --- */

/* The step of the row that begins at `line`, of `length` bytes with its newline; -1: the line is no row. */
static int64_t step_of_row(const unsigned char *line, size_t length)
{
    int64_t step = 0;
    size_t k = 0;
    for (; k < length && k < 18 && line[k] >= '0' && line[k] <= '9'; k++)
        step = 10 * step + (line[k] - '0');
    return k > 0 && k < length && line[k] == ',' ? step : -1;
}

/* Sets *keep to the bytes of the heading and of the rows before `step`; 0: there is no such row. A last line
 * without its newline was being written when the run ended, after its last checkpoint. */
static enum dm2_status find_rows(const char *path, const unsigned char *text, size_t n, int64_t step,
                                 size_t *keep, struct dm2_error *err)
{
    size_t head = sizeof heading - 1, at = head;
    int64_t last = 0;
    *keep = 0;
    if (n < head || memcmp(text, heading, head) != 0)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: has another heading: it is not the table that the checkpoint needs", path);
    while (at < n) {
        const unsigned char *end = memchr(text + at, '\n', n - at);
        size_t length = end == NULL ? 0 : (size_t)(end - (text + at)) + 1;
        int64_t of = end == NULL ? step : step_of_row(text + at, length);
        if (of < last)
            return dm2_fail(err, DM2_PROTOCOL,
                            "%s: its byte %zu does not begin a row of step %" PRId64
                            " or later: bring the tables of the run directory along with its checkpoint",
                            path, at, last);
        if (of >= step)
            break;
        last = of;
        at += length;
    }
    *keep = at > head ? at : 0;
    return DM2_OK;
}

static enum dm2_status remove_table(const char *path, struct dm2_error *err)
{
    if (unlink(path) != 0 && errno != ENOENT)
        return dm2_fail(err, DM2_IO, "%s: cannot remove it: %s", path, strerror(errno));
    return DM2_OK;
}

/* Makes `to` hold the first `keep` bytes of `text`, which was read from `from`. */
static enum dm2_status take_over(const char *from, const char *part, const char *to, bool whole,
                                 bool in_place, const unsigned char *text, size_t keep, struct file_out *f,
                                 struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    if (keep == 0)
        return in_place ? remove_table(whole ? from : part, err) : DM2_OK;
    if (in_place && whole)
        status = file_rename(from, part, err);
    if (status == DM2_OK && in_place)
        return file_reopen(f, to, keep, err);
    if (status == DM2_OK)
        status = file_create(f, to, err);
    if (status == DM2_OK) {
        file_write(f, text, keep);
        status = file_flush(f, err);
    }
    return status;
}

enum dm2_status cracks_resume(const char *directory, const char *source, int64_t step, bool in_place,
                              struct file_out *f, struct dm2_error *err)
{
    unsigned char *text = NULL;
    size_t n = 0, keep = 0;
    char *from = text_join(source, "/", cracks_table),
         *part = from == NULL ? NULL : text_join(from, ".part", "");
    char *to = text_join(directory, "/", cracks_table);
    enum dm2_status status = part == NULL || to == NULL ? run_directory_no_memory(err) : DM2_OK;
    bool whole = status == DM2_OK && access(part, F_OK) != 0;
    if (status == DM2_OK && !(whole && access(from, F_OK) != 0)) {
        status = file_read(whole ? from : part, SIZE_MAX / 4, &text, &n, err);
        if (status == DM2_OK)
            status = find_rows(whole ? from : part, text, n, step, &keep, err);
        if (status == DM2_OK)
            status = take_over(from, part, to, whole, in_place, text, keep, f, err);
    }
    free(text);
    free(from);
    free(part);
    free(to);
    return status;
}
