/* The schedule does not determine at which steps links break. A run that continues counts the rows instead:
 * each link of the first row of history.csv is in the state or has a row here. Links that formed later
 * (`link_form`) may have rows as well. */
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

/* The rows before the step of the state: their bytes with the heading, and how many are behind `from`. */
struct found_rows {
    size_t keep;
    int64_t behind;
};

/* A last line without its newline was being written when the run ended, after its last checkpoint. */
static enum dm2_status find_rows(const char *path, const unsigned char *text, size_t n, int64_t step,
                                 int64_t from, struct found_rows *out, struct dm2_error *err)
{
    size_t head = sizeof heading - 1, at = head;
    int64_t last = 0;
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
        out->behind += of > from;
        last = of;
        at += length;
    }
    out->keep = at > head ? at : 0;
    return DM2_OK;
}

static enum dm2_status check_count(const char *path, bool there, int64_t step, const struct crack_count *want,
                                   int64_t rows, struct dm2_error *err)
{
    if (want->from < 0 || rows >= want->rows)
        return DM2_OK;
    char has[60] = "is not there";
    if (there)
        (void)snprintf(has, sizeof has, "has %" PRId64 " rows of these steps", rows);
    return dm2_fail(
        err, DM2_PROTOCOL,
        "%s: %s, but at least %" PRId64 " links broke after step %" PRId64 " and before step %" PRId64
        ", as history.csv and the state say: bring the tables of the run directory along with its "
        "checkpoint",
        path, has, want->rows, want->from, step);
}

enum dm2_status cracks_check(const char *source, int64_t step, const struct crack_count *count,
                             struct crack_rows *out, struct dm2_error *err)
{
    size_t n = 0;
    struct found_rows found = {0};
    char *from = text_join(source, "/", cracks_table),
         *part = from == NULL ? NULL : text_join(from, ".part", "");
    enum dm2_status status = part == NULL ? run_directory_no_memory(err) : DM2_OK;
    *out = (struct crack_rows){.whole = status == DM2_OK && access(part, F_OK) != 0};
    out->there = status == DM2_OK && !(out->whole && access(from, F_OK) != 0);
    const char *path = out->whole ? from : part;
    if (out->there)
        status = file_read(path, SIZE_MAX / 4, &out->text, &n, err);
    if (status == DM2_OK && out->there)
        status = find_rows(path, out->text, n, step, count->from, &found, err);
    if (status == DM2_OK)
        status = check_count(out->there ? path : from, out->there, step, count, found.behind, err);
    out->keep = found.keep;
    free(from);
    free(part);
    return status;
}

void cracks_free(struct crack_rows *rows)
{
    free(rows->text);
    *rows = (struct crack_rows){0};
}

static enum dm2_status remove_table(const char *path, struct dm2_error *err)
{
    if (unlink(path) != 0 && errno != ENOENT)
        return dm2_fail(err, DM2_IO, "%s: cannot remove it: %s", path, strerror(errno));
    return DM2_OK;
}

/* Cuts the table `to` of the run's own directory, whose name until the run ends is `part`. */
static enum dm2_status cut_table(const struct crack_rows *rows, const char *to, const char *part,
                                 struct file_out *f, struct dm2_error *err)
{
    if (rows->keep == 0)
        return remove_table(rows->whole ? to : part, err);
    enum dm2_status status = rows->whole ? file_rename(to, part, err) : DM2_OK;
    return status == DM2_OK ? file_reopen(f, to, rows->keep, err) : status;
}

enum dm2_status cracks_take(const struct crack_rows *rows, const char *directory, bool in_place,
                            struct file_out *f, struct dm2_error *err)
{
    if (!rows->there || (rows->keep == 0 && !in_place))
        return DM2_OK;
    char *to = text_join(directory, "/", cracks_table),
         *part = to == NULL ? NULL : text_join(to, ".part", "");
    enum dm2_status status = part == NULL ? run_directory_no_memory(err) : DM2_OK;
    if (status == DM2_OK && in_place) {
        status = cut_table(rows, to, part, f, err);
    } else if (status == DM2_OK) {
        status = file_create(f, to, err);
        if (status == DM2_OK) {
            file_write(f, rows->text, rows->keep);
            status = file_flush(f, err);
        }
    }
    free(to);
    free(part);
    return status;
}
