/* Status codes, and the error text that belongs to a failure.
 *
 * A function that can fail returns an enum dm2_status, DM2_OK on success, and on failure fills the struct
 * dm2_error that its caller passed. The text is a whole sentence: the place, the expectation, the remedy.
 * Only the program (src/app) prints the text, once. */
#ifndef DM2_BASE_STATUS_H
#define DM2_BASE_STATUS_H

enum dm2_status {
    DM2_OK = 0,
    DM2_USAGE,      /* an invalid command line; exit status 2 */
    DM2_DECK,       /* a deck (input file) with an error of syntax or an unphysical value; exit status 2 */
    DM2_MEMORY,     /* an allocation failed or a size overflowed */
    DM2_IO,         /* a file could not be opened, read, written or renamed */
    DM2_NET,        /* a peer is absent, refused, closed or reset; exit status 3 in the client */
    DM2_TIMEOUT,    /* a peer was silent past its deadline; exit status 3 in the client */
    DM2_PROTOCOL,   /* invalid bytes from a peer or a file; exit status 3 in the client */
    DM2_NUMERIC,    /* non-finite, out of the representable range, a lost particle */
    DM2_INTERRUPTED /* a signal asked the program to end, and nothing is lost; exit status 4 */
};

struct dm2_error {
    enum dm2_status status; /* DM2_OK until a failure */
    char text[600];         /* NUL-terminated, no newline at its end */
};

/* Fills *err, unless err is NULL, from the format and returns `status`, so that a caller can write
 * `return dm2_fail(err, DM2_IO, "...")`. A text longer than err->text is cut. */
enum dm2_status dm2_fail(struct dm2_error *err, enum dm2_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The exit status of a program that ends with `status`: 0 to 4 (README.md lists them). */
int dm2_exit_code(enum dm2_status status);

#endif
