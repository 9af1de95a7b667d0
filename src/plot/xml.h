/* A small pull parser for XML: enough for VTK's files and the pictures of this program, and strict about
 * well-formedness.
 *
 * Known are elements, attributes, text, comments, the XML declaration, the five named entities and numeric
 * entities. A document type, CDATA and other processing instructions are errors. Names are ASCII. */
#ifndef DM2_PLOT_XML_H
#define DM2_PLOT_XML_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"

enum { XML_DEPTH_MAX = 32, XML_ATTRIBUTES_MAX = 24 };

struct xml_span {
    const char *at;
    size_t length;
};

enum xml_event {
    XML_START, /* an element begins: `name`, attributes; an empty one (<a/>) is followed by its XML_END */
    XML_END,   /* an element ends: `name` */
    XML_TEXT,  /* raw text between tags, entities not resolved: `text` */
    XML_DONE,  /* the document is complete and well-formed */
    XML_ERROR
};

struct xml {
    const char *path; /* for messages */
    const char *at, *begin, *end;
    struct xml_span name, text;
    size_t n_attributes;
    struct xml_span attribute[XML_ATTRIBUTES_MAX], value[XML_ATTRIBUTES_MAX];
    int depth; /* open elements */
    struct xml_span open[XML_DEPTH_MAX];
    bool empty, had_root, began; /* empty: the last XML_START was <a/> */
};

/* Starts at text[0..length). `text` and `path` are borrowed. */
void xml_open(struct xml *x, const char *path, const char *text, size_t length);

/* The next event. XML_ERROR: the text is not well-formed; *err has path:line and the fault. No further
 * call after an XML_ERROR. */
enum xml_event xml_next(struct xml *x, struct dm2_error *err);

/* Whether the span equals `text`. */
bool xml_is(struct xml_span span, const char *text);

/* The raw value of an attribute of the element that began last; .at is NULL where the element lacks the
 * attribute. */
struct xml_span xml_attribute(const struct xml *x, const char *name);

/* The line of the present position, from 1. */
size_t xml_line(const struct xml *x);

#endif
