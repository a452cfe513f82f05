/* SPDX-License-Identifier: MIT
 * How does Node bake without standing still? start(scene, options, onProgress) copies what it is given, and returns
 * { promise, cancel, abandon } at once; a thread of its own, not one of libuv's four, does the work and sends word
 * back.
 */
#include "bake_job.h"
#include "js_value.h"

#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double REPORT_EVERY_S = 0.05;

#define WORK "hemibake_work.so"

/* Lives until the promise is settled; cancel() may outlive it, so the way to the job is cut then. */
typedef struct task {
    bake_job *job;
    pthread_t thread;
    bool joined;
    napi_env env;
    napi_deferred deferred;
    napi_threadsafe_function mail;
    double last_report_s;
    struct cancel_handle *handle;
} task;

typedef struct cancel_handle {
    task *task; /* NULL: it is over. Main thread only. */
    int users;
} cancel_handle;

typedef struct letter {
    bool over;
    double fraction;
    char stage[24];
} letter;

static void handle_release(cancel_handle *handle) {
    if (--handle->users == 0) free(handle);
}

/* ---- on the thread of the bake ----------------------------------------------------------------------------------- */

static void send(task *t, bool over, const hemi_progress *progress) {
    letter *l = calloc(1, sizeof *l);
    if (!l) return;
    l->over = over;
    l->fraction = progress ? progress->fraction : 1.0;
    snprintf(l->stage, sizeof l->stage, "%s", progress ? progress->stage : "");
    if (napi_call_threadsafe_function(t->mail, l, napi_tsfn_nonblocking) != napi_ok) free(l);
}

static void report(void *user, const hemi_progress *progress) {
    task *t = user;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    double now_s = (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
    if (now_s - t->last_report_s < REPORT_EVERY_S && progress->fraction < 1.0) return;
    t->last_report_s = now_s;
    send(t, false, progress);
}

/* hemibake_work.so lies beside this file. NULL: message says why. */
static job_run_fn *find_job_run(char message[JOB_MESSAGE_SIZE]) {
    char path[PATH_MAX] = "";
    Dl_info own;
    job_run_fn *run = NULL;
    if (dladdr(&REPORT_EVERY_S, &own) && own.dli_fname) snprintf(path, sizeof path, "%s", own.dli_fname);
    char *name = strrchr(path, '/');
    snprintf(message, JOB_MESSAGE_SIZE, "the library cannot be loaded: the addon does not know where it is");
    if (!name || (size_t)(path + sizeof path - name) < sizeof WORK) return NULL;
    /* Neither goes while the process lives: threads that are not joined end in them. */
    dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    memcpy(name + 1, WORK, sizeof WORK);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE),
         *symbol = library ? dlsym(library, "job_run") : NULL;
    /* Copied as bytes: C has no cast from an object pointer to a function pointer. */
    if (symbol) memcpy(&run, &symbol, sizeof run);
    *message = 0;
    if (!run) snprintf(message, JOB_MESSAGE_SIZE, "the library cannot be loaded: %s", dlerror());
    return run;
}

static void *work(void *user) {
    task *t = user;
    job_run_fn *run = find_job_run(t->job->message);
    if (run)
        run(t->job);
    else
        t->job->code = HEMI_ERROR_FILE;
    send(t, true, NULL);
    return NULL;
}

/* ---- on the main thread ------------------------------------------------------------------------------------------ */

static void join(task *t) {
    if (!t->joined) pthread_join(t->thread, NULL);
    t->joined = true;
}

static void stop_at_exit(void *user) {
    task *t = user;
    atomic_store(&t->job->stop, true);
    join(t);
}

static void settle(napi_env env, task *t) {
    bake_job *job = t->job;
    napi_value code, text, error;
    if (job->code == HEMI_OK) {
        napi_resolve_deferred(env, t->deferred, result_make(env, job));
        return;
    }
    static const char *const names[] = {
#define RESULT_NAME(name, text) #name,
        HEMI_RESULTS(RESULT_NAME)
#undef RESULT_NAME
    };
    napi_create_string_utf8(env, names[job->code], NAPI_AUTO_LENGTH, &code);
    napi_create_string_utf8(env, job->message, NAPI_AUTO_LENGTH, &text);
    napi_create_error(env, code, text, &error);
    napi_reject_deferred(env, t->deferred, error);
}

static void finish(napi_env env, task *t) {
    napi_remove_env_cleanup_hook(env, stop_at_exit, t);
    /* Not joined: its last word may have come long before it gets the processor again to end. */
    if (!t->joined) pthread_detach(t->thread);
    settle(env, t);
    t->handle->task = NULL;
    handle_release(t->handle);
    napi_release_threadsafe_function(t->mail, napi_tsfn_release);
    job_free(t->job);
    free(t);
}

static void open_letter(napi_env env, napi_value callback, void *context, void *data) {
    letter *l = data;
    napi_value arguments[2], nothing;
    if (env && l->over) {
        finish(env, context);
    } else if (env && callback) {
        napi_get_undefined(env, &nothing);
        napi_create_double(env, l->fraction, &arguments[0]);
        napi_create_string_utf8(env, l->stage, NAPI_AUTO_LENGTH, &arguments[1]);
        napi_call_function(env, nothing, callback, 2, arguments, NULL);
    }
    free(l);
}

static napi_value cancel(napi_env env, napi_callback_info info) {
    void *data;
    napi_get_cb_info(env, info, NULL, NULL, NULL, &data);
    cancel_handle *handle = data;
    if (handle->task) atomic_store(&handle->task->job->stop, true);
    return NULL;
}

/* process.exit() runs no cleanup hooks, but destructors of Mesa's libraries, which no bake may be inside of. */
static napi_value abandon(napi_env env, napi_callback_info info) {
    void *data;
    napi_get_cb_info(env, info, NULL, NULL, NULL, &data);
    cancel_handle *handle = data;
    if (handle->task) stop_at_exit(handle->task);
    return NULL;
}

static void forget_handle(napi_env env, void *data, void *hint) {
    (void)env, (void)hint;
    handle_release(data);
}

static void add_function(napi_env env, napi_value object, const char *name, napi_callback call, cancel_handle *handle) {
    napi_value function;
    napi_create_function(env, name, NAPI_AUTO_LENGTH, call, handle, &function);
    napi_add_finalizer(env, function, handle, forget_handle, NULL, NULL);
    napi_set_named_property(env, object, name, function);
}

static bool begin(napi_env env, task *t, napi_value callback) {
    napi_value name;
    napi_create_string_utf8(env, "hemibake", NAPI_AUTO_LENGTH, &name);
    if (napi_create_threadsafe_function(env, callback, NULL, name, 0, 1, NULL, NULL, t, open_letter, &t->mail) !=
        napi_ok)
        return false;
    t->job->report = report;
    t->job->report_user = t;
    if (pthread_create(&t->thread, NULL, work, t) != 0) {
        napi_release_threadsafe_function(t->mail, napi_tsfn_abort);
        return false;
    }
    napi_add_env_cleanup_hook(env, stop_at_exit, t);
    return true;
}

static napi_value fail(napi_env env, task *t, const char *text) {
    bool pending = false;
    napi_is_exception_pending(env, &pending);
    if (!pending) napi_throw_error(env, "HEMI_ERROR_MEMORY", text);
    if (t && t->job) job_free(t->job);
    if (t) free(t->handle);
    free(t);
    return NULL;
}

static napi_value start(napi_env env, napi_callback_info info) {
    napi_value arguments[3], out, promise;
    napi_valuetype type = napi_undefined;
    size_t count = 3;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    napi_typeof(env, arguments[2], &type);
    task *t = calloc(1, sizeof *t);
    if (!t) return fail(env, t, "out of memory");
    t->env = env;
    t->job = calloc(1, sizeof *t->job);
    t->handle = calloc(1, sizeof *t->handle);
    if (!t->job || !t->handle) return fail(env, t, "out of memory");
    if (!job_read(env, arguments[0], arguments[1], t->job)) return fail(env, t, "the scene cannot be read");
    *t->handle = (cancel_handle){ t, 3 };
    if (!begin(env, t, type == napi_function ? arguments[2] : NULL)) return fail(env, t, "no thread to work on");
    napi_create_promise(env, &t->deferred, &promise);
    napi_create_object(env, &out);
    napi_set_named_property(env, out, "promise", promise);
    add_function(env, out, "cancel", cancel, t->handle);
    add_function(env, out, "abandon", abandon, t->handle);
    return out;
}

static void set_text(napi_env env, napi_value object, const char *name, const char *text) {
    napi_value value;
    if (text && napi_create_string_utf8(env, text, NAPI_AUTO_LENGTH, &value) == napi_ok)
        napi_set_named_property(env, object, name, value);
}

/* [{ name, kind, argument, help, index, documents }, ...]: what bake and bakeScene take; documents: bake alone. */
static napi_value make_options(napi_env env) {
    napi_value out, one, documents;
    uint32_t count = 0;
    napi_create_array(env, &out);
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (!(OPTIONS[i].marks & (MARK_SCENES | MARK_DOCUMENTS))) continue;
        napi_create_object(env, &one);
        set_text(env, one, "name", OPTIONS[i].name);
        set_text(env, one, "kind", option_kind_name(OPTIONS[i].kind));
        set_text(env, one, "argument", OPTIONS[i].argument);
        set_text(env, one, "help", OPTIONS[i].help);
        js_set_number(env, one, "index", i);
        napi_get_boolean(env, OPTIONS[i].marks & MARK_DOCUMENTS, &documents);
        napi_set_named_property(env, one, "documents", documents);
        napi_set_element(env, out, count++, one);
    }
    return out;
}

NAPI_MODULE_INIT() {
    napi_value function;
    /* hemibake brings its own threads; llvmpipe reads this when its first context is made. */
    setenv("LP_NUM_THREADS", "0", 0);
    napi_create_function(env, "start", NAPI_AUTO_LENGTH, start, NULL, &function);
    napi_set_named_property(env, exports, "start", function);
    set_text(env, exports, "version", HEMI_VERSION_STRING);
    napi_set_named_property(env, exports, "options", make_options(env));
    return exports;
}
