/* The server of a live view, on libwebsockets. */
#include "server.h"
#include "open_browser.h"
#include "session.h"
#include "signals.h"

#include <libwebsockets.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

enum {
    TOKEN = 32,     /* hexadecimal digits */
    MESSAGE = 4096, /* longest message of the page, bytes */
    CHUNK = 1 << 16,
    CHECK_US = 100000, /* interval at which signals are looked for */
};

struct server {
    struct lws_context *lws;
    struct session *session;
    const char *page;
    size_t page_size;
    char token[TOKEN + 1], origin[64];
    struct lws *viewer; /* the WebSocket of the page; NULL: none */
    char message[MESSAGE];
    size_t received; /* bytes of a message that came in fragments */
    lws_sorted_usec_list_t check;
};

static volatile sig_atomic_t ended;

static void on_signal(int number) {
    (void)number;
    ended = 1;
}

/* ---- access ---------------------------------------------------------------------------------- */

static bool make_token(char token[TOKEN + 1]) {
    unsigned char random[TOKEN / 2];
    if (getrandom(random, sizeof random, 0) != sizeof random) return false;
    for (int k = 0; k < TOKEN / 2; k++) sprintf(token + 2 * k, "%02x", random[k]);
    return true;
}

/* Whether a request has the token, and comes from no other site: a browser names the site of a page
 * in "Origin" for every WebSocket. */
static bool is_allowed(const struct server *server, struct lws *wsi, bool needs_origin) {
    char text[256];
    const char *token = lws_get_urlarg_by_name(wsi, "token=", text, sizeof text);
    if (!token || strlen(token) != TOKEN || lws_timingsafe_bcmp(token, server->token, TOKEN))
        return false;
    int length = lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN);
    if (!length) return !needs_origin;
    return lws_hdr_copy(wsi, text, sizeof text, WSI_TOKEN_ORIGIN) > 0 &&
           !strcmp(text, server->origin);
}

static int refuse(struct lws *wsi, unsigned code) {
    if (lws_return_http_status(wsi, code, NULL)) return -1;
    return lws_http_transaction_completed(wsi) ? -1 : 1;
}

/* ---- the page -------------------------------------------------------------------------------- */

static bool add_header(struct lws *wsi, const char *name, const char *value, unsigned char **at,
                       unsigned char *end) {
    return !lws_add_http_header_by_name(wsi, (const unsigned char *)name,
                                        (const unsigned char *)value, (int)strlen(value), at, end);
}

/* The page may load nothing, and talks to this server alone. */
static bool send_headers(const struct server *server, struct lws *wsi) {
    unsigned char buffer[LWS_PRE + 2048], *start = buffer + LWS_PRE, *at = start;
    unsigned char *end = buffer + sizeof buffer;
    char policy[256];
    snprintf(policy, sizeof policy,
             "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
             "img-src data: blob:; connect-src ws%s; frame-ancestors 'none'",
             strchr(server->origin, ':'));
    return !lws_add_http_common_headers(wsi, 200, "text/html; charset=utf-8", server->page_size,
                                        &at, end) &&
           add_header(wsi, "Content-Security-Policy:", policy, &at, end) &&
           add_header(wsi, "Referrer-Policy:", "no-referrer", &at, end) &&
           add_header(wsi, "X-Content-Type-Options:", "nosniff", &at, end) &&
           add_header(wsi, "Cache-Control:", "no-store", &at, end) &&
           !lws_finalize_write_http_header(wsi, start, &at, end);
}

/* The next piece of the page; *sent: bytes so far. */
static int send_piece(const struct server *server, struct lws *wsi, size_t *sent) {
    unsigned char buffer[LWS_PRE + CHUNK];
    size_t left = server->page_size - *sent, size = left < CHUNK ? left : CHUNK;
    memcpy(buffer + LWS_PRE, server->page + *sent, size);
    enum lws_write_protocol kind = size == left ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP;
    if (lws_write(wsi, buffer + LWS_PRE, size, kind) != (int)size) return -1;
    *sent += size;
    if (kind == LWS_WRITE_HTTP) return lws_callback_on_writable(wsi), 0;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static int start_page(const struct server *server, struct lws *wsi, const char *path,
                      size_t *sent) {
    if (!is_allowed(server, wsi, false)) return refuse(wsi, HTTP_STATUS_FORBIDDEN) < 0 ? -1 : 0;
    if (strcmp(path, "/")) return refuse(wsi, HTTP_STATUS_NOT_FOUND) < 0 ? -1 : 0;
    *sent = 0;
    if (!send_headers(server, wsi)) return -1;
    return lws_callback_on_writable(wsi), 0;
}

static int serve_page(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                      size_t size) {
    struct server *server = lws_context_user(lws_get_context(wsi));
    if (reason == LWS_CALLBACK_HTTP) return start_page(server, wsi, in, user);
    if (reason == LWS_CALLBACK_HTTP_WRITEABLE) return send_piece(server, wsi, user);
    if (reason == LWS_CALLBACK_HTTP_CONFIRM_UPGRADE && !is_allowed(server, wsi, true))
        return refuse(wsi, HTTP_STATUS_FORBIDDEN);
    return lws_callback_http_dummy(wsi, reason, user, in, size);
}

/* ---- the WebSocket --------------------------------------------------------------------------- */

static int close_viewer(struct lws *wsi, const char *reason) {
    lws_close_reason(wsi, LWS_CLOSE_STATUS_POLICY_VIOLATION, (unsigned char *)reason,
                     strlen(reason));
    return -1;
}

static int send_frame(struct server *server, struct lws *wsi) {
    struct bytes frame;
    if (wsi != server->viewer) return close_viewer(wsi, "opened in another window");
    if (!session_take(server->session, &frame)) return 0;
    unsigned char *buffer = malloc(LWS_PRE + frame.size);
    if (!buffer) report_no_memory();
    else memcpy(buffer + LWS_PRE, frame.data, frame.size);
    bool good =
        buffer && lws_write(wsi, buffer + LWS_PRE, frame.size, LWS_WRITE_BINARY) >= (int)frame.size;
    free(buffer);
    free(frame.data);
    return good ? 0 : -1;
}

static int receive(struct server *server, struct lws *wsi, const void *in, size_t size) {
    if (wsi != server->viewer) return 0;
    if (server->received + size > MESSAGE) return close_viewer(wsi, "a message is too long");
    memcpy(server->message + server->received, in, size);
    server->received += size;
    if (lws_remaining_packet_payload(wsi) || !lws_is_final_fragment(wsi)) return 0;
    size = server->received;
    server->received = 0;
    if (session_receive(server->session, server->message, size)) return 0;
    return close_viewer(wsi, "too many messages wait for the end of a step");
}

static int connect_viewer(struct server *server, struct lws *wsi) {
    if (server->viewer) lws_callback_on_writable(server->viewer); /* is closed there */
    server->viewer = wsi;
    server->received = 0;
    return 0;
}

static int serve_viewer(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                        size_t size) {
    struct server *server = lws_context_user(lws_get_context(wsi));
    (void)user;
    if (reason == LWS_CALLBACK_ESTABLISHED) return connect_viewer(server, wsi);
    if (reason == LWS_CALLBACK_RECEIVE) return receive(server, wsi, in, size);
    if (reason == LWS_CALLBACK_SERVER_WRITEABLE) return send_frame(server, wsi);
    if (reason == LWS_CALLBACK_EVENT_WAIT_CANCELLED && server->viewer)
        lws_callback_on_writable(server->viewer);
    if (reason == LWS_CALLBACK_CLOSED && wsi == server->viewer) server->viewer = NULL;
    return 0;
}

/* ---- running --------------------------------------------------------------------------------- */

/* From the thread of the simulation. */
static void wake(void *self) { lws_cancel_service(((struct server *)self)->lws); }

/* A signal that comes between two waits of the loop does not end the second one. */
static void check_signals(lws_sorted_usec_list_t *check) {
    struct server *server = lws_container_of(check, struct server, check);
    lws_sul_schedule(server->lws, 0, check, check_signals, CHECK_US);
}

static int listen_at(struct server *server, int port) {
    static const struct lws_protocols protocols[] = {
        {.name = "http", .callback = serve_page, .per_session_data_size = sizeof(size_t)},
        {.name = "live", .callback = serve_viewer, .rx_buffer_size = MESSAGE},
        {0}};
    struct lws_context_creation_info info = {.port = port,
                                             .iface = "127.0.0.1",
                                             .protocols = protocols,
                                             .user = server,
                                             .gid = (gid_t)-1,
                                             .uid = (uid_t)-1,
                                             .options = LWS_SERVER_OPTION_DISABLE_IPV6 |
                                                        LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND};
    lws_set_log_level(0, NULL);
    server->lws = lws_create_context(&info);
    struct lws_vhost *host = server->lws ? lws_get_vhost_by_name(server->lws, "default") : NULL;
    if (!host) {
        fprintf(stderr, "projdyn: view: cannot listen on 127.0.0.1:%d; is the port in use?\n",
                port);
        return EXIT_FAILED;
    }
    snprintf(server->origin, sizeof server->origin, "http://127.0.0.1:%d",
             lws_get_vhost_listen_port(host));
    return EXIT_GOOD;
}

static void catch_signals(void) {
    signals_catch(on_signal, SA_RESETHAND);
    signal(SIGPIPE, SIG_IGN);
}

/* Serves until a signal; the second one ends the program at once. */
static void serve(struct server *server, const struct server_options *options) {
    char url[128], folder[TEMPORARY_FOLDER] = "";
    snprintf(url, sizeof url, "%s/?token=%s", server->origin, server->token);
    printf("%s\nCtrl-C ends.\n", url);
    fflush(stdout);
    if (options->open_browser) open_browser(url, folder);
    check_signals(&server->check);
    while (!ended && lws_service(server->lws, 0) >= 0)
        ;
    temporary_folder_remove(folder);
}

int server_run(struct live *live, const char *page, const struct server_options *options) {
    struct server server = {.page = page, .page_size = strlen(page)};
    catch_signals();
    if (!make_token(server.token)) return report_write_error("/dev/urandom");
    int code = listen_at(&server, options->port);
    if (code == EXIT_GOOD) server.session = session_start(live, wake, &server);
    if (code == EXIT_GOOD && !server.session) code = EXIT_FAILED;
    if (code == EXIT_GOOD) serve(&server, options);
    session_stop(server.session);
    if (server.lws) lws_context_destroy(server.lws);
    return code;
}
