/* Fuzz target: the bytes are the text of a deck. */
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/deck/deck.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char name[] = "fuzz.dm2", *text = malloc(size + 1);
    if (text == NULL || memchr(data, '\0', size) != NULL) {
        free(text);
        return 0;
    }
    memcpy(text, data, size);
    text[size] = '\0';
    struct deck_text one = {.name = name, .text = text, .length = size};
    const struct deck_source source = {.texts = &one, .n_texts = 1, .steps = -1};
    struct deck_report report = {0};
    struct config config;
    if (deck_load(&source, &config, &report) == DM2_OK)
        config_free(&config);
    deck_report_free(&report);
    free(text);
    return 0;
}
