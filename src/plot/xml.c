/* XML, pulled event by event out of a text in memory. Spans point into the text, so that nothing is
 * copied.
 *
 * Well-formedness is checked on the way: tags nest, there is one root, attributes are quoted and unique,
 * `<` and `&` occur only where they are allowed, and there are no control characters. Lines are counted
 * only for a message. */
#include "xml.h"

#include <ctype.h>
#include <string.h>

void xml_open(struct xml *x, const char *path, const char *text, size_t length)
{
    memset(x, 0, sizeof *x);
    x->path = path;
    x->at = x->begin = text;
    x->end = text + length;
}

size_t xml_line(const struct xml *x)
{
    size_t line = 1;
    for (const char *c = x->begin; c < x->at; c++)
        line += *c == '\n' ? 1 : 0;
    return line;
}

bool xml_is(struct xml_span span, const char *text)
{
    return span.at != NULL && strlen(text) == span.length && memcmp(span.at, text, span.length) == 0;
}

struct xml_span xml_attribute(const struct xml *x, const char *name)
{
    for (size_t i = 0; i < x->n_attributes; i++)
        if (xml_is(x->attribute[i], name))
            return x->value[i];
    return (struct xml_span){NULL, 0};
}

static enum xml_event fail_at_line(const struct xml *x, struct dm2_error *err, const char *what)
{
    (void)dm2_fail(err, DM2_PROTOCOL, "%s:%zu: not well-formed XML: %s", x->path, xml_line(x), what);
    return XML_ERROR;
}

static bool begins_with(const struct xml *x, const char *text)
{
    size_t n = strlen(text);
    return (size_t)(x->end - x->at) >= n && memcmp(x->at, text, n) == 0;
}

static void skip_space(struct xml *x)
{
    while (x->at < x->end && strchr(" \t\r\n", *x->at) != NULL && *x->at != '\0')
        x->at++;
}

static bool is_name_start(char c)
{
    return isalpha((unsigned char)c) || c == '_' || c == ':';
}

static struct xml_span take_name(struct xml *x)
{
    struct xml_span name = {x->at, 0};
    if (x->at == x->end || !is_name_start(*x->at))
        return name;
    while (x->at < x->end &&
           (is_name_start(*x->at) || isdigit((unsigned char)*x->at) || *x->at == '-' || *x->at == '.'))
        x->at++;
    name.length = (size_t)(x->at - name.at);
    return name;
}

/* Whether an entity begins at `c`, which points to a '&'; *length is the entity's length. */
static bool is_entity(const char *c, const char *end, size_t *length)
{
    static const char *const named[] = {"&lt;", "&gt;", "&amp;", "&quot;", "&apos;"};
    for (size_t i = 0; i < sizeof named / sizeof named[0]; i++) {
        *length = strlen(named[i]);
        if ((size_t)(end - c) >= *length && memcmp(c, named[i], *length) == 0)
            return true;
    }
    const char *at = c + 1;
    if (at == end || *at++ != '#')
        return false;
    bool hexadecimal = at < end && *at == 'x';
    at += hexadecimal ? 1 : 0;
    const char *digits = at;
    while (at < end && (hexadecimal ? isxdigit((unsigned char)*at) : isdigit((unsigned char)*at)))
        at++;
    *length = (size_t)(at - c) + 1;
    return at > digits && at < end && *at == ';';
}

/* NULL, or the fault in the characters of a text or of an attribute's value. */
static const char *find_fault(struct xml_span span)
{
    const char *end = span.at + span.length;
    size_t entity;
    for (const char *c = span.at; c < end; c++) {
        if ((unsigned char)*c < 0x20 && *c != '\n' && *c != '\t' && *c != '\r')
            return "a control character";
        if (*c == '<')
            return "a '<' inside a value";
        if (*c == '&' && !is_entity(c, end, &entity))
            return "an '&' that begins no entity";
    }
    return NULL;
}

static const char *take_attribute(struct xml *x)
{
    struct xml_span name = take_name(x);
    if (name.length == 0)
        return "an attribute's name was expected";
    if (x->n_attributes == XML_ATTRIBUTES_MAX)
        return "too many attributes";
    for (size_t i = 0; i < x->n_attributes; i++)
        if (x->attribute[i].length == name.length && memcmp(x->attribute[i].at, name.at, name.length) == 0)
            return "an attribute is there twice";
    skip_space(x);
    if (x->at == x->end || *x->at != '=')
        return "a '=' was expected after an attribute's name";
    x->at++;
    skip_space(x);
    if (x->at == x->end || (*x->at != '"' && *x->at != '\''))
        return "a quoted value was expected";
    const char *close = memchr(x->at + 1, *x->at, (size_t)(x->end - x->at - 1));
    if (close == NULL)
        return "a quoted value does not end";
    struct xml_span value = {x->at + 1, (size_t)(close - x->at - 1)};
    x->attribute[x->n_attributes] = name;
    x->value[x->n_attributes++] = value;
    x->at = close + 1;
    return find_fault(value);
}

/* Reads the attributes up to '>', '/' or '?'. Returns NULL, or the fault. */
static const char *take_attributes(struct xml *x)
{
    for (;;) {
        const char *before = x->at;
        skip_space(x);
        if (x->at == x->end)
            return "a tag does not end";
        if (*x->at == '>' || *x->at == '/' || *x->at == '?')
            return NULL;
        if (x->at == before)
            return "a blank was expected before an attribute";
        const char *what = take_attribute(x);
        if (what != NULL)
            return what;
    }
}

static enum xml_event take_start(struct xml *x, struct dm2_error *err)
{
    x->at++;
    x->n_attributes = 0;
    x->name = take_name(x);
    if (x->name.length == 0)
        return fail_at_line(x, err, "an element's name was expected");
    if (x->depth == 0 && x->had_root)
        return fail_at_line(x, err, "a second root element");
    const char *what = take_attributes(x);
    if (what != NULL)
        return fail_at_line(x, err, what);
    if (*x->at == '?')
        return fail_at_line(x, err, "a stray '?'");
    x->empty = *x->at == '/';
    x->at += x->empty ? 1 : 0;
    if (x->at == x->end || *x->at != '>')
        return fail_at_line(x, err, "a '>' was expected");
    x->at++;
    if (x->depth == XML_DEPTH_MAX)
        return fail_at_line(x, err, "elements nest too deeply");
    x->open[x->depth++] = x->name;
    x->had_root = true;
    return XML_START;
}

static enum xml_event take_end(struct xml *x, struct dm2_error *err)
{
    x->at += 2;
    x->name = take_name(x);
    skip_space(x);
    if (x->at == x->end || *x->at != '>')
        return fail_at_line(x, err, "a '>' was expected");
    x->at++;
    if (x->depth == 0)
        return fail_at_line(x, err, "an end tag without its start");
    struct xml_span open = x->open[--x->depth];
    if (open.length != x->name.length || memcmp(open.at, x->name.at, open.length) != 0)
        return fail_at_line(x, err, "an end tag that does not match the start tag");
    return XML_END;
}

/* A skip function skips one construct and returns NULL, or the fault. */
static const char *skip_declaration(struct xml *x)
{
    if (x->began)
        return "an XML declaration that is not at the beginning";
    x->at += strlen("<?xml");
    x->n_attributes = 0;
    const char *what = take_attributes(x);
    if (what != NULL)
        return what;
    if (!begins_with(x, "?>"))
        return "the XML declaration does not end";
    x->at += 2;
    return NULL;
}

static const char *skip_comment(struct xml *x)
{
    x->at += 4;
    while (x->at < x->end && !begins_with(x, "--"))
        x->at++;
    if (!begins_with(x, "-->"))
        return "a comment that does not end, or '--' inside it";
    x->at += 3;
    return NULL;
}

enum xml_event xml_next(struct xml *x, struct dm2_error *err)
{
    if (x->empty) {
        x->empty = false;
        x->name = x->open[--x->depth];
        return XML_END;
    }
    for (;;) {
        const char *what = NULL;
        if (begins_with(x, "<?xml"))
            what = skip_declaration(x);
        else if (begins_with(x, "<!--"))
            what = skip_comment(x);
        else
            break;
        x->began = true;
        if (what != NULL)
            return fail_at_line(x, err, what);
    }
    x->began = true;
    if (x->at == x->end) {
        if (x->depth != 0)
            return fail_at_line(x, err, "the text ends inside an element");
        return x->had_root ? XML_DONE : fail_at_line(x, err, "there is no element");
    }
    if (begins_with(x, "</"))
        return take_end(x, err);
    if (*x->at == '<')
        return take_start(x, err);
    const char *next = memchr(x->at, '<', (size_t)(x->end - x->at));
    x->text = (struct xml_span){x->at, (size_t)((next == NULL ? x->end : next) - x->at)};
    const char *what = find_fault(x->text);
    if (what != NULL)
        return fail_at_line(x, err, what);
    if (x->depth == 0) {
        skip_space(x);
        if (x->at < x->text.at + x->text.length)
            return fail_at_line(x, err, "text outside of the root element");
        return xml_next(x, err);
    }
    x->at = x->text.at + x->text.length;
    return XML_TEXT;
}
