/* A line consists of words: the first is host[:port], the others are slots=K and spare. An unknown word is an
 * error with file and line, because a typing mistake must not silently take a machine out of the run. */
#include "dm2/cluster/hosts.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/text.h"
#include "dm2/cluster/messages.h"

enum { FILE_MOST = 1024 * 1024 }; /* bytes of a hosts file */

enum dm2_status endpoints_add(struct endpoints *list, const char *host, int port, struct dm2_error *err)
{
    struct endpoint *grown = mem_grown(list->items, &list->cap, list->n, list->n + 1, sizeof *grown);
    if (grown == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %zu servers", list->n + 1);
    list->items = grown;
    struct endpoint *e = &list->items[list->n++];
    (void)snprintf(e->host, sizeof e->host, "%s", host);
    e->port = port;
    e->spare = false;
    e->line = 0;
    return DM2_OK;
}

size_t endpoints_sort(struct endpoints *list)
{
    size_t front = 0;
    for (size_t k = 0; k < list->n; k++) {
        struct endpoint e = list->items[k];
        if (e.spare)
            continue;
        memmove(&list->items[front + 1], &list->items[front], (k - front) * sizeof e);
        list->items[front++] = e;
    }
    return front;
}

void endpoints_free(struct endpoints *list)
{
    free(list->items);
    *list = (struct endpoints){0};
}

/* Parses the whole text as an integer within from..to. False: the text is none. */
static bool parse_number(const char *text, size_t length, int from, int to, int *out)
{
    int64_t value;
    if (!number_parse_integer(text, length, &value) || value < from || value > to)
        return false;
    *out = (int)value;
    return true;
}

/* Splits host[:port] and sets out->host, out->port. Returns NULL, or the mistake as a text for the user. */
static const char *split_server(const char *text, size_t length, struct endpoint *out)
{
    const char *host = text, *end = text + length, *colon = NULL;
    size_t host_length = length;
    if (length > 0 && text[0] == '[') {
        const char *close = memchr(text, ']', length);
        if (close == NULL)
            return "the '[' of the address is not closed";
        host = text + 1;
        host_length = (size_t)(close - host);
        if (close + 1 < end && close[1] != ':')
            return "after ']' only :port may follow";
        colon = close + 1 < end ? close + 1 : NULL;
    } else {
        colon = memchr(text, ':', length);
        if (colon != NULL && memchr(colon + 1, ':', (size_t)(end - colon - 1)) != NULL)
            colon = NULL; /* several colons: an IPv6 address without a port */
        else if (colon != NULL)
            host_length = (size_t)(colon - host);
    }
    if (host_length == 0)
        return "the host's name is empty";
    if (host_length > HOST_MAX)
        return "the host's name is longer than 255 characters";
    memcpy(out->host, host, host_length);
    out->host[host_length] = '\0';
    out->port = DEFAULT_PORT;
    if (colon != NULL && !parse_number(colon + 1, (size_t)(end - colon - 1), 1, 65535, &out->port))
        return "the port must be a number from 1 to 65535";
    return NULL;
}

/* The order of host and port; capitals do not count. */
static int compare_endpoints(const struct endpoint *a, const struct endpoint *b)
{
    int hosts = strcasecmp(a->host, b->host);
    return hosts != 0 ? hosts : a->port - b->port;
}

enum dm2_status hosts_parse_server(const char *text, struct endpoints *list, struct dm2_error *err)
{
    struct endpoint e;
    const char *wrong = split_server(text, strlen(text), &e);
    if (wrong != NULL)
        return dm2_fail(err, DM2_USAGE, "server '%s': %s; write HOST or HOST:PORT", text, wrong);
    for (size_t k = 0; k < list->n; k++)
        if (compare_endpoints(&list->items[k], &e) == 0)
            return dm2_fail(err, DM2_USAGE, "server '%s' is named before: name each server once", text);
    return endpoints_add(list, e.host, e.port, err);
}

/* Takes the next word of a line that ends at `end`. False: the line has no further word. */
static bool take_word(const char **at, const char *end, const char **word, size_t *length)
{
    while (*at < end && (**at == ' ' || **at == '\t' || **at == '\r'))
        ++*at;
    *word = *at;
    while (*at < end && strchr(" \t\r", **at) == NULL)
        ++*at;
    *length = (size_t)(*at - *word);
    return *length > 0;
}

static enum dm2_status parse_line(const char *name, int line, const char *at, const char *end,
                                  struct endpoints *list, struct dm2_error *err)
{
    const char *word;
    size_t length;
    struct endpoint e;
    int slots = 1;
    bool spare = false;
    if (!take_word(&at, end, &word, &length))
        return DM2_OK;
    const char *wrong = split_server(word, length, &e);
    if (wrong != NULL)
        return dm2_fail(err, DM2_USAGE, "%s:%d: '%.*s': %s; a line is host[:port] [slots=K] [spare]", name,
                        line, (int)length, word, wrong);
    while (take_word(&at, end, &word, &length)) {
        if (length == 5 && memcmp(word, "spare", 5) == 0) {
            spare = true;
            continue;
        }
        if (length < 6 || memcmp(word, "slots=", 6) != 0)
            return dm2_fail(err, DM2_USAGE,
                            "%s:%d: '%.*s' is not known; a line is host[:port] [slots=K] [spare]", name, line,
                            (int)length, word);
        if (!parse_number(word + 6, length - 6, 1, HOSTS_MOST, &slots) || e.port + slots - 1 > 65535)
            return dm2_fail(err, DM2_USAGE,
                            "%s:%d: '%.*s': slots must be a number from 1 on, and port + slots - 1 at most "
                            "65535",
                            name, line, (int)length, word);
    }
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < slots && status == DM2_OK; k++) {
        status = endpoints_add(list, e.host, e.port + k, err);
        if (status == DM2_OK) {
            list->items[list->n - 1].spare = spare;
            list->items[list->n - 1].line = line;
        }
    }
    return status;
}

static int compare_places(const void *a, const void *b)
{
    const struct endpoint *x = *(struct endpoint *const *)a, *y = *(struct endpoint *const *)b;
    int order = compare_endpoints(x, y);
    return order != 0 ? order : (x > y) - (x < y);
}

/* Refuses a server that the list has twice; the error names the first such server of the file. */
static enum dm2_status refuse_repeated(const char *name, const struct endpoints *list, struct dm2_error *err)
{
    struct endpoint **sorted = mem_alloc(list->n, sizeof *sorted);
    const struct endpoint *again = NULL, *before = NULL;
    if (sorted == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %zu servers", list->n);
    for (size_t k = 0; k < list->n; k++)
        sorted[k] = &list->items[k];
    qsort(sorted, list->n, sizeof *sorted, compare_places);
    for (size_t k = 1; k < list->n; k++)
        if (compare_endpoints(sorted[k - 1], sorted[k]) == 0 && (again == NULL || sorted[k] < again)) {
            before = sorted[k - 1];
            again = sorted[k];
        }
    free(sorted);
    if (again == NULL)
        return DM2_OK;
    return dm2_fail(
        err, DM2_USAGE,
        "%s:%d: %s:%d is named before, in line %d; slots=K stands for K servers, on the ports from the "
        "line's on",
        name, again->line, again->host, again->port, before->line);
}

enum dm2_status hosts_parse(const char *name, const char *text, struct endpoints *list, struct dm2_error *err)
{
    size_t before = list->n;
    int line = 1;
    for (const char *at = text; *at != '\0'; line++) {
        const char *end = at + strcspn(at, "\n"), *stop = memchr(at, '#', (size_t)(end - at));
        enum dm2_status status = parse_line(name, line, at, stop == NULL ? end : stop, list, err);
        if (status != DM2_OK)
            return status;
        at = *end == '\n' ? end + 1 : end;
    }
    if (list->n == before)
        return dm2_fail(err, DM2_USAGE, "%s names no host; a line is host[:port] [slots=K] [spare]", name);
    return refuse_repeated(name, list, err);
}

enum dm2_status hosts_read(const char *path, struct endpoints *list, struct dm2_error *err)
{
    unsigned char *text;
    size_t n;
    struct dm2_error why = {0};
    if (file_read(path, FILE_MOST, &text, &n, &why) != DM2_OK)
        return dm2_fail(err, DM2_USAGE, "%s", why.text);
    enum dm2_status status =
        memchr(text, '\0', n) != NULL
            ? dm2_fail(err, DM2_USAGE, "%s is not a text file: it holds a NUL byte", path)
            : hosts_parse(path, (const char *)text + text_mark((const char *)text, n), list, err);
    free(text);
    return status;
}
