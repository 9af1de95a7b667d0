/* Fuzz target: byte 0 chooses a hosts file, a network of --allow, a table or a snapshot, which users give to
 * the programs besides decks; the other bytes are the text. */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/csv.h"
#include "dm2/cluster/hosts.h"
#include "dm2/net/allow.h"
#include "dm2/plot/vtp_reader.h"

static void read_table(const char *text, size_t n)
{
    struct csv csv;
    double *numbers;
    if (csv_parse("fuzz", text, n, &csv, NULL) != DM2_OK)
        return;
    if (csv_numbers(&csv, 0, &numbers, NULL) == DM2_OK)
        free(numbers);
    csv_free(&csv);
}

static void read_snapshot(const char *text, size_t n)
{
    const char *directory = getenv("TMPDIR");
    char path[400];
    struct vtp vtp;
    (void)snprintf(path, sizeof path, "%s/fuzz-vtp-%ld", directory == NULL ? "/tmp" : directory,
                   (long)getpid());
    FILE *file = fopen(path, "wb");
    if (file == NULL)
        return;
    (void)fwrite(text, 1, n, file);
    (void)fclose(file);
    if (vtp_read(path, &vtp, NULL) == DM2_OK) {
        (void)vtp_value(&vtp, "TimeValue", 0);
        vtp_free(&vtp);
    }
    (void)unlink(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct endpoints list = {0};
    struct allow_list allow = {0};
    if (size == 0)
        return 0;
    char *text = malloc(size); /* of the exact size, so that a read beyond the end is found */
    if (text == NULL)
        return 0;
    memcpy(text, data + 1, size - 1);
    text[size - 1] = '\0';
    switch (data[0]) {
    case 'h':
        (void)hosts_parse("fuzz", text, &list, NULL);
        endpoints_free(&list);
        break;
    case 'a':
        (void)allow_add(&allow, text, NULL);
        (void)allow_address(&allow, "10.1.2.3");
        break;
    case 't':
        read_table(text, size - 1);
        break;
    case 's':
        read_snapshot(text, size - 1);
        break;
    default:
        break;
    }
    free(text);
    return 0;
}
