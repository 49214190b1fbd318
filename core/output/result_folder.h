// A result folder that appears whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace hairbake {

/// Throws Error(usage) when results may not go to `folder`: it is no folder, a mount point, or holds files that are not
/// those of an earlier result. Such a result (a manifest.json of hairbake and nothing that it does not list) may be
/// replaced.
void check_result_folder(const std::filesystem::path& folder);

/// Also proves that results can be written to `folder`: makes the staging folder, with the parents that are missing,
/// and removes both again.
/// Throws as check_result_folder() and as the constructor of ResultFolder.
void prove_writable(const std::filesystem::path& folder);

/// An input file, and the name by which the person knows it ("hair").
struct NamedInput {
    std::string name;
    std::filesystem::path file;
};

/// Writing a result replaces the whole folder, so it would delete the inputs inside.
///   inputs: files or folders; those that are not there are passed over
/// Throws Error(usage) naming the first input that lies in `folder`, by its path or as the target of a link.
void check_outside(const std::filesystem::path& folder, std::span<const NamedInput> inputs);

/// The hidden folder in which the files of `folder` are written before they are moved into place. It lies beside
/// `folder` and is named after it, this machine and this process.
std::filesystem::path staging_folder(const std::filesystem::path& folder);

/// Removes this process's staging folder for `folder`, if there is one. A ResultFolder that is writing there fails to
/// commit from then on. For a process that is about to end; may be called from another thread than the writer's.
void discard_staging(const std::filesystem::path& folder) noexcept;

/// Write files to path(), then commit(). Without commit() nothing remains.
class ResultFolder {
public:
    /// Checks `folder`, makes the staging folder (and missing parents) and removes those that killed processes of this
    /// machine left for the same folder.
    /// Throws Error(usage), Error(out_of_resources).
    /// Throws Error(bad_input) when the place is not writable.
    explicit ResultFolder(const std::filesystem::path& folder);
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    const std::filesystem::path& path() const { return staging_; }

    /// A message in which path() is the folder as the caller wrote it.
    std::string as_given(std::string text) const;

    /// Moves the files into place in one step of the file system, which also removes an earlier result from there.
    void commit();

private:
    void replace();

    std::filesystem::path given_;  ///< as the caller wrote it, for messages
    std::filesystem::path folder_, staging_;
    std::filesystem::path made_parent_;  ///< topmost parent that was made here, or empty
    bool committed_ = false;
};

}  // namespace hairbake
