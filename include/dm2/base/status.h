/* Status codes and the one error text that travels with them.
 *
 * A function that can fail returns an enum dm2_status, 0 on success, and fills the struct dm2_error
 * that its caller passed. The text is a whole sentence: where, what was expected, what to do. It is
 * printed once, by the program (src/app), never where it arises. */
#ifndef DM2_BASE_STATUS_H
#define DM2_BASE_STATUS_H

enum dm2_status {
    DM2_OK = 0,
    DM2_USAGE,      /* a command line that does not read; exit status 2 */
    DM2_DECK,       /* a deck (input file) that does not read or is unphysical; exit status 2 */
    DM2_MEMORY,     /* an allocation failed or a size overflowed */
    DM2_IO,         /* a file could not be opened, read, written or renamed */
    DM2_NET,        /* a peer is absent, refused, closed or reset; exit status 3 in the client */
    DM2_TIMEOUT,    /* a peer was silent past its deadline; exit status 3 in the client */
    DM2_PROTOCOL,   /* bytes from a peer or a file that do not decode; exit status 3 in the client */
    DM2_NUMERIC,    /* non-finite, out of the representable range, a lost particle */
    DM2_INTERRUPTED /* a signal asked the program to end */
};

struct dm2_error {
    enum dm2_status status; /* DM2_OK until something failed */
    char text[600];         /* NUL-terminated, no newline at its end */
};

/* Fills *err (which may be NULL) from the format and returns `status`, so that a caller can write
 * `return dm2_fail(err, DM2_IO, "...")`. A text that is too long is cut. */
enum dm2_status dm2_fail(struct dm2_error *err, enum dm2_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The exit status of a program that ends with this status: 0, 1, 2 or 3 (docs: README). */
int dm2_exit_code(enum dm2_status status);

#endif
