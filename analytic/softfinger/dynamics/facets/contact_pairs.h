#pragma once

#include <cstddef>
#include <vector>

/// Internal: the unknowns of the contact problem, numbered for LemkePath.
namespace softfinger::internal {

/// One unknown of a contact and the row that is complementary to it.
struct ContactPair {
  enum class Kind {
    normal,  ///< P_i with v_n,i
    slip,    ///< lambda_i with mu_i P_i - e^T beta_i
    vertex   ///< beta_ij with D_ij^T v_t,i + lambda_i
  };
  Kind kind;
  int contact;
  int vertex;  ///< j, of Kind::vertex
};

/// Numbers of the complementary pairs. With nc contacts of u vertices each, P_i is number i,
/// lambda_i nc + i, beta_ij 2 nc + u i + j.
class ContactPairs {
 public:
  ContactPairs(int contact_capacity, int vertex_capacity)
      : pairs_(std::size_t(contact_capacity) * std::size_t(vertex_capacity + 2)) {}

  /// Costs nothing where the numbers are those of the last problem.
  void number(int contacts, int vertices) {
    if (contacts_ == contacts && vertices_ == vertices) return;
    contacts_ = contacts;
    vertices_ = vertices;
    int next = 0;
    const auto add = [&](const ContactPair& pair) { pairs_[std::size_t(next++)] = pair; };
    for (int i = 0; i < contacts; ++i) add({ContactPair::Kind::normal, i, 0});
    for (int i = 0; i < contacts; ++i) add({ContactPair::Kind::slip, i, 0});
    for (int i = 0; i < contacts; ++i)
      for (int j = 0; j < vertices; ++j) add({ContactPair::Kind::vertex, i, j});
  }

  int size() const { return contacts_ * (vertices_ + 2); }
  int vertices() const { return vertices_; }  ///< u
  const ContactPair& operator[](int index) const { return pairs_[std::size_t(index)]; }

  int normal(int contact) const { return contact; }
  int slip(int contact) const { return contacts_ + contact; }
  int vertex(int contact, int vertex) const { return 2 * contacts_ + slot(contact, vertex); }
  /// The place of beta_ij in arrays over the vertices of all contacts.
  int slot(int contact, int vertex) const { return contact * vertices_ + vertex; }

 private:
  int contacts_ = -1, vertices_ = -1;
  std::vector<ContactPair> pairs_;
};

}  // namespace softfinger::internal
