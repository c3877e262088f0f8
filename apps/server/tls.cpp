#include "apps/server/tls.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>

#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <unistd.h>

#if CAROM_WITH_TLS
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>
#endif

namespace carom::server {

namespace fs = std::filesystem;

namespace {

core::Result<std::string> read_text(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return core::Error{path + ": there is no such file"};
  if (fs::file_size(path, error) > 1u << 20) return core::Error{path + ": expected a PEM file of at most 1 MiB"};
  std::ifstream in(path, std::ios::binary);
  if (!in) return core::Error{path + ": cannot be read"};
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace

#if CAROM_WITH_TLS

namespace {

struct Free {
  void operator()(BIO* p) const { BIO_free_all(p); }
  void operator()(EVP_PKEY* p) const { EVP_PKEY_free(p); }
  void operator()(EVP_PKEY_CTX* p) const { EVP_PKEY_CTX_free(p); }
  void operator()(X509* p) const { X509_free(p); }
  void operator()(X509_EXTENSION* p) const { X509_EXTENSION_free(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

// Browsers refuse certificates that last longer than 398 days.
constexpr long valid_days = 397, renew_days = 14;

core::Error failure(const char* what) {
  char text[256] = "no reason given";
  if (const unsigned long code = ERR_get_error(); code != 0) ERR_error_string_n(code, text, sizeof text);
  return core::Error{std::string(what) + ": " + text};
}

bool is_address(const std::string& name) {
  unsigned char bytes[16];
  return inet_pton(AF_INET, name.c_str(), bytes) == 1 || inet_pton(AF_INET6, name.c_str(), bytes) == 1;
}

/// Letters, digits, dots and hyphens: nothing that an extension's text could take for its own syntax.
bool is_name(const std::string& name) {
  return !name.empty() && name.size() < 254 &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '.' || c == '-'; });
}

/// This machine's names and addresses, and those given.
std::set<std::string> all_names(std::span<const std::string> names) {
  std::set<std::string> out{"localhost", "127.0.0.1", "::1"};
  char host[256] = {};
  if (gethostname(host, sizeof host - 1) == 0) {
    out.insert(host);
    out.insert(std::string(host) + ".local");
  }
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) == 0) {
    for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
      if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
      char text[INET_ADDRSTRLEN] = {};
      const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
      if (inet_ntop(AF_INET, &address->sin_addr, text, sizeof text) != nullptr) out.insert(text);
    }
    freeifaddrs(list);
  }
  out.insert(names.begin(), names.end());
  std::erase_if(out, [](const std::string& name) { return !is_address(name) && !is_name(name); });
  return out;
}

bool extend(X509* certificate, int what, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const Owned<X509_EXTENSION> extension(X509V3_EXT_conf_nid(nullptr, &context, what, value.c_str()));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

Owned<X509> parse_certificate(const std::string& pem) {
  const Owned<BIO> in(BIO_new_mem_buf(pem.data(), int(pem.size())));
  return Owned<X509>(in ? PEM_read_bio_X509(in.get(), nullptr, nullptr, nullptr) : nullptr);
}
Owned<EVP_PKEY> parse_key(const std::string& pem) {
  const Owned<BIO> in(BIO_new_mem_buf(pem.data(), int(pem.size())));
  const auto no_password = [](char*, int, int, void*) { return 0; };
  return Owned<EVP_PKEY>(in ? PEM_read_bio_PrivateKey(in.get(), nullptr, no_password, nullptr) : nullptr);
}

std::string text_in(BIO* memory) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory, &data);
  return std::string(data, std::size_t(std::max(size, 0L)));
}

/// Whether it will be good for a while, by all these names.
bool serves(X509* certificate, const std::set<std::string>& names) {
  int days = 0, seconds = 0;
  if (ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate)) != 1 || days < renew_days) return false;
  return std::all_of(names.begin(), names.end(), [certificate](const std::string& name) {
    return is_address(name) ? X509_check_ip_asc(certificate, name.c_str(), 0) == 1
                            : X509_check_host(certificate, name.c_str(), name.size(), 0, nullptr) == 1;
  });
}

std::string user_folder() {
  if (const char* config = std::getenv("XDG_CONFIG_HOME"); config != nullptr && *config == '/')
    return std::string(config) + "/carom";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return std::string(home) + "/.config/carom";
  return {};
}

/// Readable by its owner alone from the moment it exists; in place at once or not at all.
core::Status write_secret(const fs::path& path, const std::string& text) {
  const std::string part = path.string() + ".part";
  ::unlink(part.c_str());
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0600);
  const bool written = file >= 0 && ::write(file, text.data(), text.size()) == ssize_t(text.size());
  if (file >= 0) ::close(file);
  if (!written || std::rename(part.c_str(), path.c_str()) != 0) {
    ::unlink(part.c_str());
    return core::Error{path.string() + ": cannot be written"};
  }
  return {};
}

}  // namespace

core::Result<TlsIdentity> make_identity(std::span<const std::string> names) {
  const Owned<EVP_PKEY_CTX> maker(EVP_PKEY_CTX_new_id(EVP_PKEY_EC, nullptr));
  EVP_PKEY* raw = nullptr;
  if (!maker || EVP_PKEY_keygen_init(maker.get()) != 1 ||
      EVP_PKEY_CTX_set_ec_paramgen_curve_nid(maker.get(), NID_X9_62_prime256v1) != 1 ||
      EVP_PKEY_keygen(maker.get(), &raw) != 1)
    return failure("no key could be made");
  const Owned<EVP_PKEY> key(raw);
  const Owned<X509> certificate(X509_new());
  unsigned char serial[8] = {};
  if (!certificate || RAND_bytes(serial, sizeof serial) != 1) return failure("no certificate could be made");
  std::uint64_t number = 0;
  for (const unsigned char byte : serial) number = number << 8 | byte;
  X509* const c = certificate.get();
  X509_NAME* const subject = X509_get_subject_name(c);
  const unsigned char common_name[] = "Carom on this machine";
  bool made = X509_set_version(c, 2) == 1 && ASN1_INTEGER_set_uint64(X509_get_serialNumber(c), number >> 1) == 1 &&
              X509_gmtime_adj(X509_getm_notBefore(c), -3600) != nullptr &&
              X509_gmtime_adj(X509_getm_notAfter(c), valid_days * 24 * 3600) != nullptr &&
              X509_set_pubkey(c, key.get()) == 1 &&
              X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC, common_name, -1, -1, 0) == 1 &&
              X509_set_issuer_name(c, subject) == 1;
  std::string alternatives;
  for (const std::string& name : all_names(names))
    alternatives += (alternatives.empty() ? "" : ",") + std::string(is_address(name) ? "IP:" : "DNS:") + name;
  made = made && extend(c, NID_basic_constraints, "critical,CA:FALSE") &&
         extend(c, NID_key_usage, "critical,digitalSignature") && extend(c, NID_ext_key_usage, "serverAuth") &&
         extend(c, NID_subject_alt_name, alternatives) && X509_sign(c, key.get(), EVP_sha256()) > 0;
  const Owned<BIO> out(BIO_new(BIO_s_mem())), key_out(BIO_new(BIO_s_mem()));
  made = made && out && key_out && PEM_write_bio_X509(out.get(), c) == 1 &&
         PEM_write_bio_PrivateKey(key_out.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1;
  if (!made) return failure("no certificate could be made");
  return TlsIdentity{text_in(out.get()), text_in(key_out.get())};
}

core::Result<TlsIdentity> user_identity(std::span<const std::string> names, const std::string& folder) {
  const std::string where = folder.empty() ? user_folder() : folder;
  if (where.empty()) return make_identity(names);  // for as long as the server runs
  const fs::path certificate_file = fs::path(where) / "tls-certificate.pem", key_file = fs::path(where) / "tls-key.pem";
  std::error_code error;
  if (fs::exists(certificate_file, error) && fs::exists(key_file, error)) {
    core::Result<TlsIdentity> found = read_identity(certificate_file.string(), key_file.string());
    if (!found.ok()) return core::Error{found.error().message + "; remove both files of " + where + " to get new ones"};
    if (const Owned<X509> certificate = parse_certificate(found->certificate);
        certificate && serves(certificate.get(), all_names(names)))
      return found;
  }
  core::Result<TlsIdentity> fresh = make_identity(names);
  if (!fresh.ok()) return fresh;
  fs::create_directories(where, error);
  if (error) return core::Error{where + ": cannot make the folder for the certificate: " + error.message()};
  if (const core::Status status = write_secret(key_file, fresh->key); !status.ok()) return status.error();
  if (const core::Status status = write_secret(certificate_file, fresh->certificate); !status.ok())
    return status.error();
  return fresh;
}

core::Result<TlsIdentity> read_identity(const std::string& certificate_file, const std::string& key_file) {
  const core::Result<std::string> certificate = read_text(certificate_file);
  if (!certificate.ok()) return certificate.error();
  const core::Result<std::string> key = read_text(key_file);
  if (!key.ok()) return key.error();
  const Owned<X509> parsed = parse_certificate(*certificate);
  if (!parsed) return core::Error{certificate_file + ": found no certificate, expected PEM text (BEGIN CERTIFICATE)"};
  const Owned<EVP_PKEY> parsed_key = parse_key(*key);
  if (!parsed_key)
    return core::Error{key_file + ": found no key without a password, expected PEM text (BEGIN PRIVATE KEY)"};
  if (X509_check_private_key(parsed.get(), parsed_key.get()) != 1)
    return core::Error{key_file + ": this key does not belong to the certificate in " + certificate_file};
  return TlsIdentity{*certificate, *key};
}

core::Result<std::string> fingerprint(const TlsIdentity& identity) {
  const Owned<X509> certificate = parse_certificate(identity.certificate);
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  if (!certificate || X509_digest(certificate.get(), EVP_sha256(), digest, &size) != 1)
    return failure("the certificate has no fingerprint");
  std::string out;
  for (unsigned int i = 0; i < size; ++i) {
    char pair[4];
    std::snprintf(pair, sizeof pair, i == 0 ? "%02X" : ":%02X", digest[i]);
    out += pair;
  }
  return out;
}

#else

namespace {
const core::Error no_tls{"this build has no TLS: install libssl-dev and build again"};
}
core::Result<TlsIdentity> make_identity(std::span<const std::string>) { return no_tls; }
core::Result<TlsIdentity> user_identity(std::span<const std::string>, const std::string&) { return no_tls; }
core::Result<TlsIdentity> read_identity(const std::string& certificate_file, const std::string&) {
  (void)read_text(certificate_file);
  return no_tls;
}
core::Result<std::string> fingerprint(const TlsIdentity&) { return no_tls; }

#endif

}  // namespace carom::server
