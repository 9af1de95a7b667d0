/* Fuzz target: the bytes are all that servers send to a client, which runs a small deck, measures the
 * network, or asks for the status, with a key or without.
 *
 *     byte 0, bits 0 and 1   0: a run; 1: the network, of one server; 2: the status
 *     bit 2                  the client has a key
 *     bit 3                  two servers (of a run)
 *     bit 4                  the client recovers from the loss of a server
 *
 * Frames follow: type, length (u16), payload. Type RAW: the payload is sent as it is, without a header. Type
 * NEXT_SERVER: the frames behind it come from the other server. With a key an empty GRANT gets the code of a
 * server that has the key, and the frames behind it get tags, so that the input reaches the code behind the
 * handshake.
 *
 * The linker replaces socket_connect and auth_nonce by two functions of this file (the Makefile's FUZZ_WRAP).
 * All bytes of a server are written when the client connects; then the stream of the server ends, so that the
 * client does not wait. */
#include "fuzz.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dm2/cluster/client.h"
#include "dm2/cluster/inquiry.h"
#include "dm2/cluster/messages.h"

enum { RAW = 254, NEXT_SERVER = 253, SERVERS = 2, CONNECTIONS_MOST = 16, MOST = 100000 };

static const char DECK[] =
    "domain { size = 1 1; r_c = 0.3; delta_r = 0.05 }\n"
    "time { dt = 0.01; steps = 3 }\n"
    "material Ni { rho0 = 8.9; c0 = 0.46; s = 1.4 }\n"
    "body b { shape = rectangle 0 0 1 1; spacing = 0.2; material = Ni; velocity = 0.01 0 }\n"
    "output { history_every = 1; snapshot_every = 2 }\n"
    "profile p { axis = x; bins = 4; every = 2 }\n";

static const struct auth_key KEY = {{1}};

/* The bytes that the servers send. */
static struct {
    const uint8_t *bytes;
    size_t length;
    bool keyed;
    int ends[CONNECTIONS_MOST]; /* the servers' ends of all connections */
    int n;
} script;

/* A reader at the first frame of a server; empty where the script has none. */
static struct bytes_reader script_of(int server)
{
    struct bytes_reader r = bytes_reader_of(script.bytes, script.length);
    while (server > 0 && bytes_remaining(&r) >= 3) {
        uint8_t type = bytes_get_u8(&r);
        uint16_t n = bytes_get_u16(&r);
        if (type == NEXT_SERVER)
            server--;
        (void)bytes_get_raw(&r, n < bytes_remaining(&r) ? n : bytes_remaining(&r));
    }
    if (server > 0)
        r = bytes_reader_of(script.bytes, 0);
    return r;
}

/* Sends GRANT with the server's code; the frames behind it have tags under the session's keys. */
static void put_grant(struct channel *ch, const struct auth_nonces *nonces)
{
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    auth_code(&KEY, AUTH_SERVER, PROTOCOL_VERSION, nonces, code);
    (void)channel_send(ch, MESSAGE_GRANT, 0, code, sizeof code, deadline_in(0, -1), NULL);
    auth_session_key(&KEY, AUTH_CLIENT, PROTOCOL_VERSION, nonces, in);
    auth_session_key(&KEY, AUTH_SERVER, PROTOCOL_VERSION, nonces, out);
    channel_use_keys(ch, in, out);
}

/* Writes all frames of a server and ends its stream. */
static void send_script(int fd, int server)
{
    struct channel ch;
    struct auth_nonces nonces = {{0}, {0}};
    struct bytes_reader r = script_of(server);
    channel_open(&ch, fd, PROTOCOL_VERSION, "the client");
    while (bytes_remaining(&r) >= 3) {
        uint8_t type = bytes_get_u8(&r);
        size_t n = bytes_get_u16(&r);
        n = n < bytes_remaining(&r) ? n : bytes_remaining(&r);
        const unsigned char *payload = bytes_get_raw(&r, n);
        struct iovec part = {(void *)(uintptr_t)payload, n};
        unsigned char welcome[LIMIT_HELLO];
        if (type == MESSAGE_WELCOME && n >= 8 && n <= LIMIT_HELLO) {
            memcpy(welcome, payload, n);
            fuzz_renew_fingerprint(welcome);
            payload = welcome;
        }
        if (type == NEXT_SERVER)
            break;
        if (type == MESSAGE_CHALLENGE && n == AUTH_NONCE)
            memcpy(nonces.server, payload, AUTH_NONCE);
        if (type == RAW)
            (void)socket_write_all(fd, &part, 1, deadline_in(0, -1), NULL);
        else if (type == MESSAGE_GRANT && n == 0 && script.keyed)
            put_grant(&ch, &nonces);
        else
            (void)channel_send(&ch, type, 0, payload, n, deadline_in(0, -1), NULL);
    }
    (void)shutdown(fd, SHUT_WR);
}

enum dm2_status __wrap_socket_connect(const char *host, int port, struct deadline until, int *fd,
                                      struct dm2_error *err);
enum dm2_status __wrap_socket_connect(const char *host, int port, struct deadline until, int *fd,
                                      struct dm2_error *err)
{
    int pair[2];
    (void)host;
    (void)until;
    *fd = -1;
    if (script.n == CONNECTIONS_MOST || socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0)
        return dm2_fail(err, DM2_NET, "no more");
    (void)fcntl(pair[0], F_SETFL, O_NONBLOCK);
    (void)fcntl(pair[1], F_SETFL, O_NONBLOCK);
    script.ends[script.n++] = pair[1];
    send_script(pair[1], port - 1);
    *fd = pair[0];
    return DM2_OK;
}

enum dm2_status __wrap_auth_nonce(unsigned char nonce[AUTH_NONCE], struct dm2_error *err);
enum dm2_status __wrap_auth_nonce(unsigned char nonce[AUTH_NONCE], struct dm2_error *err)
{
    (void)err;
    memset(nonce, 0, AUTH_NONCE);
    return DM2_OK;
}

/* The deck, loaded once. */
struct prepared {
    bool ready;
    struct deck_text text;
    struct deck_source source;
    struct config config;
    struct model *model;
    struct decomposition cuts[SERVERS];
};

static struct prepared *prepare_run(void)
{
    static struct prepared p;
    static char name[] = "fuzz.dm2", text[sizeof DECK];
    if (p.ready)
        return &p;
    memcpy(text, DECK, sizeof DECK);
    p.text = (struct deck_text){.name = name, .text = text, .length = sizeof DECK - 1};
    p.source = (struct deck_source){.texts = &p.text, .n_texts = 1, .steps = -1};
    struct deck_report report = {0};
    if (deck_load(&p.source, &p.config, &report) != DM2_OK) {
        (void)fprintf(stderr, "%s\n", report.text);
        abort();
    }
    deck_report_free(&report);
    if (model_build(&p.config, &p.model, NULL) != DM2_OK)
        abort();
    for (int k = 0; k < SERVERS; k++)
        if (decomposition_bisect(model_grid(p.model), k + 1, NULL, &p.cuts[k], NULL) != DM2_OK)
            abort();
    p.ready = true;
    return &p;
}

static void run_client(const struct client_options *options, int ranks)
{
    struct prepared *p = prepare_run();
    const struct state_origin origin = {.next_id = UINT32_MAX, .next_grain = UINT32_MAX};
    const char *directory = getenv("TMPDIR");
    char path[400];
    struct run_report report;
    struct client_job job = {
        .source = &p->source, .config = &p->config, .model = p->model, .decomposition = &p->cuts[ranks - 1]};
    (void)snprintf(path, sizeof path, "%s/fuzz-client-%ld", directory == NULL ? "/tmp" : directory,
                   (long)getpid());
    if (results_open(path, true, &p->config, model_scales(p->model), &origin, &job.results, NULL) != DM2_OK)
        return;
    if (client_run(&job, options, &report, NULL) == DM2_OK)
        free(report.servers);
    results_abort(job.results);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct endpoint servers[SERVERS] = {{.host = "127.0.0.1", .port = 1},
                                              {.host = "127.0.0.1", .port = 2}};
    const uint32_t sizes[] = {4};
    double seconds[2];
    struct client_echo echo = {.bytes = sizes, .sizes = 1, .repeats = 2, .budget = 0, .seconds = seconds};
    if (size == 0 || size > MOST)
        return 0;
    script.bytes = data + 1;
    script.length = size - 1;
    script.keyed = (data[0] & 4) != 0;
    script.n = 0;
    socket_ignore_sigpipe();
    const struct client_options options = {.servers = servers,
                                           .recover = (data[0] & 16) != 0,
                                           .copy_every = 1,
                                           .deck_path = "fuzz.dm2",
                                           .version = "1.0.0", /* that of the inputs */
                                           .timeout = 1,
                                           .hash_every = 1,
                                           .cancel = -1,
                                           .key = script.keyed ? &KEY : NULL,
                                           .echo = (data[0] & 3) == 1 ? &echo : NULL};
    struct report_message status;
    if ((data[0] & 3) == 1)
        (void)client_measure_network(&options, 1, NULL);
    else if ((data[0] & 3) == 2)
        (void)inquiry_ask(&servers[0], options.key, 1, -1, &status, NULL);
    else
        run_client(&options, (data[0] & 8) != 0 ? 2 : 1);
    while (script.n > 0)
        (void)close(script.ends[--script.n]);
    return 0;
}
