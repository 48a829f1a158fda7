// edit/session_lock.h: the file `lock` in a session's folder, by which one process at a time
// changes the session, and none while others read it.
#pragma once

#include <string>

namespace sdfgrid {

// Held while it lives; the system lets go of it when the process ends, however.
class SessionLock {
 public:
  enum class Use { reading, writing };

  SessionLock() = default;  // of nothing
  // Takes the lock of the session in `folder`. For writing the file is made if it is missing, for
  // reading nothing is. Throws Error{failed}, without waiting, if another process has it in a way
  // that does not go with this one, and where the folder cannot be written for writing.
  SessionLock(const std::string& folder, Use use);
  ~SessionLock();
  SessionLock(SessionLock&& other) noexcept;
  SessionLock& operator=(SessionLock&& other) noexcept;
  SessionLock(const SessionLock&) = delete;
  SessionLock& operator=(const SessionLock&) = delete;

  [[nodiscard]] bool held() const { return file_ >= 0; }

 private:
  int file_ = -1;
};

}  // namespace sdfgrid
