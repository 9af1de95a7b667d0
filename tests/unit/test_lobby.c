/* The lobby of a server, in this process: which visitors get a session, the answers of a busy and of a free
 * server, and which visitor leaves a full lobby. */
#include "check.h"

#include <fcntl.h>
#include <sys/socket.h>

#include "dm2/base/clock.h"
#include "dm2/cluster/messages.h"
#include "cluster/lobby.h"

static const struct auth_key KEY = {{1, 2, 3}}, OTHER = {{1, 2, 4}};
static const struct session_summary SESSION = {.deck = "a.dm2", .rank = 1, .ranks = 2, .steps = 7};

static struct server_options options_with(const struct auth_key *key)
{
    return (struct server_options){
        .deck_dir = ".", .version = "test", .handshake = 10, .timeout = 5, .cancel = -1, .key = key};
}

static struct lobby opened(int listener, const struct server_options *options)
{
    struct lobby l;
    lobby_open(&l, listener, options, NULL, NULL);
    return l;
}

static void make_busy(struct lobby *l)
{
    l->business = (struct lobby_business){.peer = "a friend", .since = clock_now(), .session = &SESSION};
}

/* Some turns of the lobby, none of which waits. */
static void look_round(struct lobby *l)
{
    for (int k = 0; k < 3; k++)
        (void)lobby_wait(l, -1, deadline_in(1e-3, -1));
}

/* The other end of a new visitor. */
static struct channel visitor(struct lobby *l)
{
    int fd[2] = {-1, -1};
    struct channel ch;
    CHECK_EQ_INT(socketpair(AF_UNIX, SOCK_STREAM, 0, fd), 0);
    (void)fcntl(fd[0], F_SETFL, O_NONBLOCK);
    (void)fcntl(fd[1], F_SETFL, O_NONBLOCK);
    lobby_enter(l, fd[0], "visitor");
    channel_open(&ch, fd[1], PROTOCOL_VERSION, "lobby");
    return ch;
}

static void put(struct channel *ch, enum message_type type, const void *payload, size_t n)
{
    CHECK_EQ_INT(channel_send(ch, (uint8_t)type, 0, payload, n, deadline_in(5, -1), NULL), DM2_OK);
}

/* The type of the message that has arrived; 0: none. */
static int got(struct channel *ch, struct frame *f)
{
    bool complete = false;
    return channel_receive_some(ch, LIMIT_SMALL, &complete, f, NULL) == DM2_OK && complete ? f->type : 0;
}

static char told[600]; /* the text of the last ERROR */

static void hear(const struct frame *f)
{
    struct error_message m;
    struct bytes_reader r = bytes_reader_of(f->payload, f->length);
    message_get_error(&r, &m);
    (void)snprintf(told, sizeof told, "%s", m.text);
}

/* Goes through the handshake with turns of the lobby in between. True: granted. */
static bool prove(struct lobby *l, struct channel *ch, enum message_type first, const struct auth_key *key)
{
    struct frame f;
    struct auth_nonces nonces = {{1}, {0}};
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    put(ch, first, nonces.client, AUTH_NONCE);
    look_round(l);
    if (got(ch, &f) != MESSAGE_CHALLENGE || f.length != AUTH_NONCE)
        return false;
    memcpy(nonces.server, f.payload, AUTH_NONCE);
    auth_code(key, first == MESSAGE_STATUS ? AUTH_ASKER : AUTH_CLIENT, PROTOCOL_VERSION, &nonces, code);
    put(ch, MESSAGE_PROOF, code, AUTH_CODE);
    look_round(l);
    int answer = got(ch, &f);
    if (answer == MESSAGE_ERROR)
        hear(&f);
    if (answer != MESSAGE_GRANT)
        return false;
    auth_session_key(key, AUTH_SERVER, PROTOCOL_VERSION, &nonces, in);
    auth_session_key(key, AUTH_CLIENT, PROTOCOL_VERSION, &nonces, out);
    channel_use_keys(ch, in, out);
    return true;
}

static struct report_message report(struct channel *ch)
{
    struct frame f;
    struct report_message m = {.step = -1};
    int type = got(ch, &f);
    CHECK_EQ_INT(type, MESSAGE_REPORT);
    if (type == MESSAGE_REPORT) {
        struct bytes_reader r = bytes_reader_of(f.payload, f.length);
        message_get_report(&r, &m);
        CHECK(!r.failed);
    }
    return m;
}

/* A waiting client gets its session before a later visitor gets an answer, because no server calls itself
 * free while a client waits. */
TEST(a_server_with_a_client_at_hand_is_not_free)
{
    const struct server_options options = options_with(NULL);
    struct lobby l = opened(-1, &options);
    const unsigned char nonce[AUTH_NONCE] = {0};
    struct channel client = visitor(&l), asker = visitor(&l), taken;
    struct frame f;
    put(&client, MESSAGE_HELLO, "hello", 5);
    put(&asker, MESSAGE_STATUS, nonce, AUTH_NONCE);
    CHECK_EQ_INT(lobby_next(&l, deadline_in(5, -1), &taken, NULL), DM2_OK);
    CHECK_EQ_INT(got(&asker, &f), 0);
    make_busy(&l);
    look_round(&l);
    struct report_message m = report(&asker);
    CHECK(m.busy);
    CHECK_STR(m.peer, "a friend");
    CHECK_EQ_INT(m.step, 7);
    CHECK_EQ_INT(m.waiting, 0);
    channel_close(&client);
    channel_close(&asker);
    channel_close(&taken);
    lobby_close(&l);
}

/* A visitor without the key does not wait: each is asked for the key, also while the server is busy, and
 * only a visitor that proves the key has a place in the queue. Its channel has the session's keys when its
 * turn comes. */
TEST(who_waits_has_proved_the_key)
{
    const struct server_options options = options_with(&KEY);
    struct lobby l = opened(-1, &options);
    struct channel stranger[3], friends[LOBBY_CLIENTS], asker, taken;
    struct frame f;
    make_busy(&l);
    for (int k = 0; k < 2; k++)
        stranger[k] = visitor(&l);
    put(&stranger[0], MESSAGE_HELLO, "hello", 5);
    look_round(&l);
    CHECK_EQ_INT(got(&stranger[0], &f), MESSAGE_ERROR);
    hear(&f);
    CHECK_STR(told, REFUSAL_TEXT);
    told[0] = '\0';
    CHECK(!prove(&l, &stranger[1], MESSAGE_KNOCK, &OTHER));
    CHECK_STR(told, REFUSAL_TEXT);
    CHECK_EQ_INT(l.n, 0);
    for (int k = 0; k < LOBBY_CLIENTS; k++) {
        friends[k] = visitor(&l);
        CHECK(prove(&l, &friends[k], MESSAGE_KNOCK, &KEY));
    }
    stranger[2] = visitor(&l); /* one client more than the queue holds gets an ERROR instead of GRANT */
    CHECK(!prove(&l, &stranger[2], MESSAGE_KNOCK, &KEY));
    CHECK_CONTAINS(told, "too many clients wait");
    CHECK_EQ_INT(l.n, LOBBY_CLIENTS);
    asker = visitor(&l);
    CHECK(prove(&l, &asker, MESSAGE_STATUS, &KEY));
    CHECK_EQ_INT(report(&asker).waiting, LOBBY_CLIENTS);
    put(&friends[0], MESSAGE_HELLO, "hello", 5);
    look_round(&l);
    CHECK_EQ_INT(lobby_next(&l, deadline_in(5, -1), &taken, NULL), DM2_OK);
    CHECK_EQ_INT(got(&taken, &f), MESSAGE_HELLO); /* the tag holds */
    CHECK_EQ_INT(l.n, LOBBY_CLIENTS - 1);
    for (int k = 0; k < LOBBY_CLIENTS; k++)
        channel_close(&friends[k]);
    for (int k = 0; k < 3; k++)
        channel_close(&stranger[k]);
    channel_close(&asker);
    channel_close(&taken);
    lobby_close(&l);
}

/* As many visitors as the lobby holds begin the handshake and then send nothing. After their second a
 * client with the key still gets in, and so does one behind it. A visitor that has proved the key keeps its
 * place. */
TEST(a_full_lobby_makes_room)
{
    const unsigned char nonce[AUTH_NONCE] = {9};
    const struct server_options options = options_with(&KEY);
    char bound[SOCKET_NAME];
    int listener = -1, fd = -1;
    CHECK_EQ_INT(socket_listen("127.0.0.1", 0, &listener, bound, NULL), DM2_OK);
    int port = (int)strtol(strrchr(bound, ':') + 1, NULL, 10);
    struct lobby l = opened(listener, &options);
    struct channel first, crowd[LOBBY_MOST - 1], late[2];
    make_busy(&l);
    first = visitor(&l);
    CHECK(prove(&l, &first, MESSAGE_KNOCK, &KEY));
    for (int k = 0; k < LOBBY_MOST - 1; k++) {
        crowd[k] = visitor(&l);
        put(&crowd[k], MESSAGE_KNOCK, nonce, AUTH_NONCE);
    }
    look_round(&l);
    CHECK_EQ_INT(l.n, LOBBY_MOST);
    for (int k = 0; k < 2; k++) {
        CHECK_EQ_INT(socket_connect("127.0.0.1", port, deadline_in(5, -1), &fd, NULL), DM2_OK);
        channel_open(&late[k], fd, PROTOCOL_VERSION, "lobby");
    }
    for (int k = 0; k < LOBBY_MOST; k++)
        l.visitors[k].came = clock_now() + 1000;
    look_round(&l);
    CHECK_STR(l.visitors[LOBBY_MOST - 1].channel.name, "visitor"); /* no visitor had to leave */
    for (int k = 0; k < LOBBY_MOST; k++)
        l.visitors[k].came = clock_now() - LOBBY_GRACE;
    look_round(&l);
    CHECK(prove(&l, &late[0], MESSAGE_KNOCK, &KEY));
    CHECK(prove(&l, &late[1], MESSAGE_STATUS, &KEY));
    struct report_message m = report(&late[1]);
    CHECK(m.busy);
    CHECK_EQ_INT(m.waiting, 2);
    CHECK_EQ_INT(l.visitors[0].kind, VISITOR_PLACED);
    channel_close(&first);
    for (int k = 0; k < LOBBY_MOST - 1; k++)
        channel_close(&crowd[k]);
    for (int k = 0; k < 2; k++)
        channel_close(&late[k]);
    lobby_close(&l);
    socket_close(listener);
}

static void put_hello(struct channel *ch, bool turn)
{
    const struct hello_message m = {.turn = turn, .fingerprint = 1, .version = "test"};
    struct bytes_writer w = {0};
    message_put_hello(&w, &m);
    put(ch, MESSAGE_HELLO, w.data, w.length);
    bytes_free(&w);
}

static struct place_message place(struct channel *ch)
{
    struct frame f;
    struct place_message m = {.step = -1};
    int type = got(ch, &f);
    CHECK_EQ_INT(type, MESSAGE_PLACE);
    if (type == MESSAGE_PLACE) {
        struct bytes_reader r = bytes_reader_of(f.payload, f.length);
        message_get_place(&r, &m);
        CHECK(!r.failed);
    }
    return m;
}

/* A busy server says at once which one it is and whom it serves, with a key and without. A client that has
 * asked holds nobody up; its session begins after the HELLO with which it takes its turn. */
TEST(who_asks_gets_a_place_at_once)
{
    socket_ignore_sigpipe();
    for (int keyed = 0; keyed < 2; keyed++) {
        const struct server_options options = options_with(keyed ? &KEY : NULL);
        struct lobby l = opened(-1, &options);
        struct channel first = visitor(&l), second = visitor(&l), taken;
        struct frame f;
        make_busy(&l);
        CHECK(!keyed || prove(&l, &first, MESSAGE_KNOCK, &KEY));
        CHECK(!keyed || prove(&l, &second, MESSAGE_KNOCK, &KEY));
        put_hello(&first, false);
        put_hello(&second, false);
        look_round(&l);
        struct place_message a = place(&first), b = place(&second);
        CHECK_STR(a.peer, "a friend");
        CHECK_EQ_INT(a.step, 7);
        CHECK_EQ_INT(a.before, 1);
        CHECK(memcmp(a.id, b.id, SERVER_ID) == 0);
        CHECK_EQ_INT(lobby_next(&l, deadline_in(0.01, -1), &taken, NULL), DM2_TIMEOUT);
        put_hello(&second, true);
        CHECK_EQ_INT(lobby_next(&l, deadline_in(5, -1), &taken, NULL), DM2_OK);
        CHECK_EQ_INT(got(&taken, &f), MESSAGE_HELLO);
        CHECK_EQ_INT(l.n, 1);
        channel_close(&first);
        look_round(&l); /* who has asked and leaves gives the place back */
        CHECK_EQ_INT(l.n, 0);
        channel_close(&second);
        channel_close(&taken);
        lobby_close(&l);
    }
}

TEST_MAIN(CASE(who_asks_gets_a_place_at_once), CASE(a_server_with_a_client_at_hand_is_not_free),
          CASE(who_waits_has_proved_the_key), CASE(a_full_lobby_makes_room))
