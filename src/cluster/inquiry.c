/* One connection carries STATUS, then with a key CHALLENGE, PROOF and GRANT, then REPORT, and closes. A
 * client with a key accepts REPORT only after GRANT. */
#include "dm2/cluster/inquiry.h"

#include <stdio.h>
#include <string.h>

#include "dm2/base/hmac.h"

/* Receives the next message, which must be of this type. */
static enum dm2_status receive_message(struct channel *ch, enum message_type type, const struct auth_key *key,
                                       struct deadline until, struct bytes_reader *out, struct dm2_error *err)
{
    struct frame f;
    struct error_message m;
    char name[2][16];
    enum dm2_status status = channel_receive(ch, LIMIT_HELLO, until, &f, err);
    if (status != DM2_OK)
        return status;
    *out = bytes_reader_of(f.payload, f.length);
    if (f.type == type)
        return DM2_OK;
    if (f.type == MESSAGE_ERROR) {
        message_get_error(out, &m);
        return dm2_fail(err, DM2_PROTOCOL, "%s: %s", ch->name,
                        strcmp(m.text, REFUSAL_TEXT) != 0 ? m.text
                        : key == NULL ? "it wants a key (--key FILE), or does not admit this machine"
                                      : "it has another key, or does not admit this machine");
    }
    if (f.type == MESSAGE_CHALLENGE && key == NULL)
        return dm2_fail(err, DM2_PROTOCOL, "%s: it wants a key (--key FILE)", ch->name);
    if (f.type == MESSAGE_REPORT && key != NULL)
        return dm2_fail(err, DM2_PROTOCOL, "%s: it has no key: start it with --key, or ask without",
                        ch->name);
    return dm2_fail(err, DM2_PROTOCOL, "%s: it sent %s where %s is due", ch->name,
                    message_name(f.type, name[0]), message_name((uint8_t)type, name[1]));
}

/* Receives a message of exactly n bytes. */
static enum dm2_status receive_bytes(struct channel *ch, enum message_type type, const struct auth_key *key,
                                     unsigned char *out, size_t n, struct deadline until,
                                     struct dm2_error *err)
{
    struct bytes_reader r;
    char name[16];
    enum dm2_status status = receive_message(ch, type, key, until, &r, err);
    if (status != DM2_OK)
        return status;
    const unsigned char *bytes = bytes_get_raw(&r, n);
    if (!bytes_done(&r))
        return dm2_fail(err, DM2_PROTOCOL, "%s: its %s message does not decode", ch->name,
                        message_name((uint8_t)type, name));
    memcpy(out, bytes, n);
    return DM2_OK;
}

/* Proves the key to the server and checks the server's proof; the channel uses session keys from here on. */
static enum dm2_status exchange_proofs(struct channel *ch, const struct auth_key *key,
                                       struct auth_nonces *nonces, struct deadline until,
                                       struct dm2_error *err)
{
    unsigned char code[AUTH_CODE], proof[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    enum dm2_status status =
        receive_bytes(ch, MESSAGE_CHALLENGE, key, nonces->server, AUTH_NONCE, until, err);
    auth_code(key, AUTH_ASKER, PROTOCOL_VERSION, nonces, code);
    if (status == DM2_OK)
        status = channel_send(ch, MESSAGE_PROOF, 0, code, AUTH_CODE, until, err);
    if (status == DM2_OK)
        status = receive_bytes(ch, MESSAGE_GRANT, key, proof, AUTH_CODE, until, err);
    if (status != DM2_OK)
        return status;
    auth_code(key, AUTH_SERVER, PROTOCOL_VERSION, nonces, code);
    if (!hmac_equal(code, proof, AUTH_CODE))
        return dm2_fail(err, DM2_PROTOCOL, "%s: it does not have the key: is this the right machine?",
                        ch->name);
    auth_session_key(key, AUTH_SERVER, PROTOCOL_VERSION, nonces, in);
    auth_session_key(key, AUTH_CLIENT, PROTOCOL_VERSION, nonces, out);
    channel_use_keys(ch, in, out);
    return DM2_OK;
}

static enum dm2_status ask_report(struct channel *ch, const struct auth_key *key, struct deadline until,
                                  struct report_message *out, struct dm2_error *err)
{
    struct auth_nonces nonces = {{0}, {0}};
    struct bytes_reader r;
    enum dm2_status status = auth_nonce(nonces.client, err);
    if (status == DM2_OK)
        status = channel_send(ch, MESSAGE_STATUS, 0, nonces.client, AUTH_NONCE, until, err);
    if (status == DM2_OK && key != NULL)
        status = exchange_proofs(ch, key, &nonces, until, err);
    if (status == DM2_OK)
        status = receive_message(ch, MESSAGE_REPORT, ch->keyed ? NULL : key, until, &r, err);
    if (status != DM2_OK)
        return status;
    message_get_report(&r, out);
    return r.failed ? dm2_fail(err, DM2_PROTOCOL, "%s: its REPORT message does not decode", ch->name)
                    : DM2_OK;
}

enum dm2_status inquiry_ask(const struct endpoint *server, const struct auth_key *key, double seconds,
                            int cancel, struct report_message *out, struct dm2_error *err)
{
    struct deadline until = deadline_in(seconds, cancel);
    struct channel ch;
    char name[SOCKET_NAME];
    int fd;
    enum dm2_status status = socket_connect(server->host, server->port, until, &fd, err);
    if (status != DM2_OK)
        return status;
    (void)snprintf(name, sizeof name, "%s:%d", server->host, server->port);
    channel_open(&ch, fd, PROTOCOL_VERSION, name);
    status = ask_report(&ch, key, until, out, err);
    channel_close(&ch);
    return status;
}
