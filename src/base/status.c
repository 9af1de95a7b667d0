/* One place formats error texts, and one place maps status codes to exit statuses. */
#include "dm2/base/status.h"

#include <stdarg.h>
#include <stdio.h>

enum dm2_status dm2_fail(struct dm2_error *err, enum dm2_status status, const char *format, ...)
{
    if (err != NULL) {
        va_list args;
        va_start(args, format);
        err->status = status;
        (void)vsnprintf(err->text, sizeof err->text, format, args);
        va_end(args);
    }
    return status;
}

int dm2_exit_code(enum dm2_status status)
{
    switch (status) {
    case DM2_OK:
        return 0;
    case DM2_USAGE:
    case DM2_DECK:
        return 2;
    case DM2_NET:
    case DM2_TIMEOUT:
    case DM2_PROTOCOL:
        return 3;
    case DM2_INTERRUPTED:
        return 4;
    case DM2_MEMORY:
    case DM2_IO:
    case DM2_NUMERIC:
        return 1;
    }
    return 1;
}
