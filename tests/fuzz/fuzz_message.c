/* The first byte chooses a message, the rest is its payload. */
#include "fuzz.h"

#include "dm2/dist/messages.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    union {
        struct hello_message hello;
        struct ready_message ready;
        struct step_message step;
        struct next_message next;
        struct state_message state;
        struct done_message done;
        struct error_message error;
        struct profile_message profile;
    } m;
    struct deck_message deck;
    struct assign_message assign;
    if (size == 0)
        return 0;
    struct bytes_reader r = bytes_reader_of(data + 1, size - 1);
    switch (data[0]) {
    case MESSAGE_HELLO:
    case MESSAGE_WELCOME:
        message_get_hello(&r, &m.hello);
        break;
    case MESSAGE_DECK:
        message_get_deck(&r, &deck);
        message_free_deck(&deck);
        break;
    case MESSAGE_ASSIGN:
        message_get_assign(&r, &assign);
        message_free_assign(&assign);
        break;
    case MESSAGE_READY:
        message_get_ready(&r, &m.ready);
        break;
    case MESSAGE_STEP:
        message_get_step(&r, &m.step);
        break;
    case MESSAGE_NEXT:
        message_get_next(&r, &m.next);
        break;
    case MESSAGE_STATE:
        message_get_state(&r, &m.state);
        break;
    case MESSAGE_DONE:
        message_get_done(&r, &m.done);
        break;
    case MESSAGE_ERROR:
        message_get_error(&r, &m.error);
        break;
    case MESSAGE_PROFILE:
        message_get_profile(&r, &m.profile);
        break;
    default:
        break;
    }
    return 0;
}
