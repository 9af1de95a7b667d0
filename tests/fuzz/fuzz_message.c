/* Fuzz target: byte 0 is the type of a message, or stands for a parcel or for records, which segments and
 * states are made of; the other bytes are the payload. */
#include "fuzz.h"

#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"

enum { PARCEL = 100, RECORDS = 101 };

/* Reads one record of each kind. */
static void get_records(struct bytes_reader *r, const struct record_limits *limits)
{
    struct element e;
    struct pair_record p;
    struct element_measure m;
    struct measures all;
    struct profile_bin bin;
    wire_get_element(r, limits, &e);
    wire_get_pair(r, limits, &p);
    wire_get_measured(r, &m);
    wire_get_measures(r, &all);
    wire_get_bin(r, &bin);
}

/* Reads a message that allocates nothing. */
static void get_message(uint8_t type, struct bytes_reader *r)
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
        struct report_message report;
        struct place_message place;
    } m;
    switch (type) {
    case MESSAGE_HELLO:
    case MESSAGE_WELCOME:
        message_get_hello(r, &m.hello);
        break;
    case MESSAGE_PLACE:
        message_get_place(r, &m.place);
        break;
    case MESSAGE_READY:
        message_get_ready(r, &m.ready);
        break;
    case MESSAGE_STEP:
        message_get_step(r, &m.step);
        break;
    case MESSAGE_NEXT:
        message_get_next(r, &m.next);
        break;
    case MESSAGE_STATE:
        message_get_state(r, &m.state);
        break;
    case MESSAGE_DONE:
        message_get_done(r, &m.done);
        break;
    case MESSAGE_ERROR:
        message_get_error(r, &m.error);
        break;
    case MESSAGE_PROFILE:
        message_get_profile(r, &m.profile);
        break;
    case MESSAGE_REPORT:
        message_get_report(r, &m.report);
        break;
    default:
        break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct deck_message deck;
    struct assign_message assign;
    struct parcel parcel;
    const struct record_limits limits = {.elements = 1000, .bodies = 4, .kinds = 4, .probes = 8};
    if (size == 0)
        return 0;
    struct bytes_reader r = bytes_reader_of(data + 1, size - 1);
    switch (data[0]) {
    case MESSAGE_DECK:
        message_get_deck(&r, &deck);
        message_free_deck(&deck);
        break;
    case MESSAGE_ASSIGN:
        message_get_assign(&r, &assign);
        message_free_assign(&assign);
        break;
    case PARCEL:
        wire_get_parcel(&r, &limits, &parcel);
        wire_parcel_free(&parcel);
        break;
    case RECORDS:
        get_records(&r, &limits);
        break;
    default:
        get_message(data[0], &r);
        break;
    }
    return 0;
}
