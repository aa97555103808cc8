#pragma once

#include <functional>
#include <stop_token>
#include <thread>

namespace runcert {

/// What an interruption asks for.
enum class Interruption {
    finish,  ///< finish what is running and begin nothing more
    stop,    ///< end what is running now
};

/// Turns signals into requests to stop, for as long as the object lives: the first SIGINT (Ctrl-C)
/// asks to finish, a second one to stop now; SIGTERM and SIGHUP ask for both at once. A signal that
/// was ignored before stays ignored, as nohup and a shell's background want it.
/// One object at a time in a process.
class Interrupts {
  public:
    /// `on_interruption` is called for each change, before the tokens see it, in a thread of this
    /// object: not in a signal handler, so it may do anything but throw. Failure if no pipe can be
    /// opened.
    explicit Interrupts(std::function<void(Interruption, int signal)> on_interruption = {});
    /// The handlers that were there before are there again.
    ~Interrupts();
    Interrupts(const Interrupts&) = delete;
    Interrupts& operator=(const Interrupts&) = delete;

    /// Requested where no new run is to begin.
    std::stop_token finish() const { return finish_.get_token(); }
    /// Requested where running programs are to be ended. `finish` is requested before.
    std::stop_token stop() const { return stop_.get_token(); }

  private:
    void listen();
    void interrupted_by(int signal);

    std::function<void(Interruption, int signal)> on_interruption_;
    std::stop_source finish_;
    std::stop_source stop_;
    std::thread listener_;
};

}  // namespace runcert
