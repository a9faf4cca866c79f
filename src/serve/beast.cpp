// Asio and Beast, compiled once: the other files see declarations alone.
#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>
