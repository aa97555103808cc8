#include "days/interrupts.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/failure.h"

namespace runcert {
namespace {

constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGHUP};
constexpr unsigned char end_of_listening = 0;

/// Brings the numbers of signals from their handler to the thread that listens. It is never closed:
/// a handler may still be writing when the object's life ends.
struct SignalPipe {
    std::array<int, 2> ends{-1, -1};
    SignalPipe() {
        if (pipe2(ends.data(), O_CLOEXEC) != 0)
            throw Failure("waiting for interrupts", std::strerror(errno), "Close other programs");
        // A handler must not wait; where so many signals fill the pipe, one more says nothing new.
        fcntl(ends[1], F_SETFL, O_NONBLOCK);
    }
};

SignalPipe& signal_pipe() {
    static SignalPipe pipe;
    return pipe;
}

int handler_writes_to = -1;
std::array<struct sigaction, signals.size()> handlers_before;
bool in_use = false;

void note_signal(int number) {
    const int error = errno;
    const auto byte = static_cast<unsigned char>(number);
    [[maybe_unused]] const ssize_t written = write(handler_writes_to, &byte, 1);
    errno = error;
}

unsigned char next_from_pipe() {
    unsigned char byte = end_of_listening;
    while (read(signal_pipe().ends[0], &byte, 1) < 0 && errno == EINTR) {
    }
    return byte;
}

}  // namespace

Interrupts::Interrupts(std::function<void(Interruption, int signal)> on_interruption)
    : on_interruption_(std::move(on_interruption)) {
    assert(!in_use);
    in_use = true;
    handler_writes_to = signal_pipe().ends[1];
    // The listener takes no signals, so that the handlers run where the caller expects them.
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    listener_ = std::thread([this] { listen(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    for (std::size_t i = 0; i < signals.size(); ++i) {
        sigaction(signals[i], nullptr, &handlers_before[i]);
        if (handlers_before[i].sa_handler == SIG_IGN) continue;
        struct sigaction action {};
        action.sa_handler = note_signal;
        action.sa_flags = SA_RESTART;
        sigfillset(&action.sa_mask);
        sigaction(signals[i], &action, nullptr);
    }
}

Interrupts::~Interrupts() {
    for (std::size_t i = 0; i < signals.size(); ++i)
        sigaction(signals[i], &handlers_before[i], nullptr);
    // Signals that came before are still heard: the pipe keeps the order.
    while (write(signal_pipe().ends[1], &end_of_listening, 1) < 0)
        std::this_thread::yield();
    listener_.join();
    in_use = false;
}

void Interrupts::listen() {
    for (unsigned char byte = next_from_pipe(); byte != end_of_listening; byte = next_from_pipe())
        interrupted_by(byte);
}

void Interrupts::interrupted_by(int signal) {
    if (stop_.stop_requested()) return;
    const bool first = !finish_.stop_requested();
    const Interruption wanted =
        signal == SIGINT && first ? Interruption::finish : Interruption::stop;
    if (on_interruption_) on_interruption_(wanted, signal);
    finish_.request_stop();
    if (wanted == Interruption::stop) stop_.request_stop();
}

}  // namespace runcert
