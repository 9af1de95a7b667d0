/* Keys, nonces and codes.
 *
 * A key file is one line of text, "dm2-key-1 " and 64 hexadecimal digits, because a line of text can be
 * pasted and copied by every program that carries files between machines. The file has mode 0600 from the
 * start, so that other users cannot read it even briefly. A file that other users can access is refused
 * rather than repaired, because the key may have been read already.
 *
 * Codes and session keys are HMAC(key, label, version, client nonce, server nonce) with different labels of
 * one length, so that no code can stand for another. */
#include "dm2/cluster/auth.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dm2/base/hmac.h"

static const char HEAD[] = "dm2-key-1 ";

enum { HEAD_LENGTH = sizeof HEAD - 1, TEXT_LENGTH = HEAD_LENGTH + 2 * AUTH_KEY + 1, LABEL = 16 };

/* Reads n bytes, or fewer at the end of the file. Returns their number, or -1. */
static ssize_t read_up_to(int fd, void *out, size_t n)
{
    size_t have = 0;
    while (have < n) {
        ssize_t got = read(fd, (char *)out + have, n - have);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        have += (size_t)got;
    }
    return (ssize_t)have;
}

enum dm2_status auth_nonce(unsigned char nonce[AUTH_NONCE], struct dm2_error *err)
{
    int fd = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
    ssize_t got = fd < 0 ? -1 : read_up_to(fd, nonce, AUTH_NONCE);
    int error = errno;
    if (fd >= 0)
        (void)close(fd);
    return got == AUTH_NONCE
               ? DM2_OK
               : dm2_fail(err, DM2_IO, "/dev/urandom gives no random numbers: %s", strerror(error));
}

static int write_key(int fd, const char *text)
{
    size_t done = 0;
    while (done < TEXT_LENGTH) {
        ssize_t put = write(fd, text + done, TEXT_LENGTH - done);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return -1;
        done += (size_t)put;
    }
    return fsync(fd);
}

enum dm2_status auth_key_create(const char *path, struct dm2_error *err)
{
    unsigned char bytes[AUTH_KEY];
    char text[TEXT_LENGTH + 1];
    enum dm2_status status = auth_nonce(bytes, err);
    if (status != DM2_OK)
        return status;
    (void)snprintf(text, sizeof text, "%s", HEAD);
    sha256_text(bytes, text + HEAD_LENGTH); /* 32 bytes as hexadecimal digits */
    text[TEXT_LENGTH - 1] = '\n';
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd < 0 && errno == EEXIST)
        return dm2_fail(err, DM2_USAGE, "%s: exists already, and a key is not overwritten: name another file",
                        path);
    if (fd < 0)
        return dm2_fail(err, DM2_IO, "%s: cannot create: %s", path, strerror(errno));
    int failed = write_key(fd, text) != 0, error = errno;
    if (close(fd) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    if (!failed)
        return DM2_OK;
    (void)unlink(path);
    return dm2_fail(err, DM2_IO, "%s: cannot write: %s", path, strerror(error));
}

static int digit_value(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

static enum dm2_status read_key(int fd, const char *path, struct auth_key *key, struct dm2_error *err)
{
    char text[TEXT_LENGTH + 1];
    struct stat info;
    if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode))
        return dm2_fail(err, DM2_USAGE, "%s: is not a regular file: make a key with dm2-server --new-key",
                        path);
    if ((info.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        return dm2_fail(
            err, DM2_USAGE,
            "%s: other users can get at this key (mode %04o): chmod 600 it, or make a new one if somebody "
            "may have read it",
            path, (unsigned)(info.st_mode & 07777));
    ssize_t got = read_up_to(fd, text, sizeof text);
    int good = got == TEXT_LENGTH && memcmp(text, HEAD, HEAD_LENGTH) == 0 && text[TEXT_LENGTH - 1] == '\n';
    for (int k = 0; k < AUTH_KEY && good; k++) {
        int high = digit_value(text[HEAD_LENGTH + 2 * k]), low = digit_value(text[HEAD_LENGTH + 2 * k + 1]);
        good = high >= 0 && low >= 0;
        key->bytes[k] = (unsigned char)(high << 4 | low);
    }
    return good ? DM2_OK
                : dm2_fail(err, DM2_USAGE,
                           "%s: holds no key: make one with dm2-server --new-key FILE and copy it", path);
}

enum dm2_status auth_key_read(const char *path, struct auth_key *key, struct dm2_error *err)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return dm2_fail(err, DM2_USAGE, "%s: cannot open the key: %s; dm2-server --new-key FILE makes one",
                        path, strerror(errno));
    enum dm2_status status = read_key(fd, path, key, err);
    (void)close(fd);
    return status;
}

static void make_code(const struct auth_key *key, const char *name, uint16_t version,
                      const struct auth_nonces *nonces, unsigned char code[AUTH_CODE])
{
    struct hmac h;
    char label[LABEL] = {0};
    unsigned char v[2] = {(unsigned char)(version & 0xff), (unsigned char)(version >> 8)};
    (void)snprintf(label, sizeof label, "%s", name);
    hmac_start(&h, key->bytes, sizeof key->bytes);
    hmac_add(&h, label, sizeof label);
    hmac_add(&h, v, sizeof v);
    hmac_add(&h, nonces->client, sizeof nonces->client);
    hmac_add(&h, nonces->server, sizeof nonces->server);
    hmac_finish(&h, code);
}

void auth_code(const struct auth_key *key, enum auth_role role, uint16_t version,
               const struct auth_nonces *nonces, unsigned char code[AUTH_CODE])
{
    static const char *const labels[] = {
        [AUTH_CLIENT] = "dm2 client", [AUTH_SERVER] = "dm2 server", [AUTH_ASKER] = "dm2 asker"};
    make_code(key, labels[role], version, nonces, code);
}

void auth_session_key(const struct auth_key *key, enum auth_role role, uint16_t version,
                      const struct auth_nonces *nonces, unsigned char out[SIPHASH_KEY])
{
    unsigned char code[AUTH_CODE];
    make_code(key, role == AUTH_SERVER ? "dm2 from server" : "dm2 from client", version, nonces, code);
    memcpy(out, code, SIPHASH_KEY);
}
