# Ruby's net/http as a client. README.md in this folder describes the commands.

require "digest"
require "net/http"
require "stringio"
require "uri"

MEDIA_TYPE = "model/obj"
$stdout.sync = true

def report(style)
  answer = yield
  $stdout.write("Ruby, #{style} | #{answer.code} | #{Digest::SHA256.hexdigest(answer.body)}\n")
rescue StandardError => error
  $stdout.write("Ruby, #{style} | lost | #{error.class} #{error.message}\n")
end

def connect(url)
  connection = Net::HTTP.new(url.host, url.port)
  connection.read_timeout = 60
  connection.max_retries = 0
  # A client that trusts the connection longer than the two seconds of Ruby's default.
  connection.keep_alive_timeout = 120
  connection.start
end

def post(url, body = nil)
  request = Net::HTTP::Post.new(url.request_uri, "Content-Type" => MEDIA_TYPE)
  request.body = body if body
  request
end

def stream(url, source)
  request = post(url)
  request["Transfer-Encoding"] = "chunked"
  request.body_stream = source
  request
end

def upload(url, path)
  connection = connect(url)
  report("whole") { connection.request(post(url, File.binread(path))) }
  report("stream") { File.open(path, "rb") { |file| connection.request(stream(url, file)) } }
  report("form") do
    File.open(path, "rb") do |file|
      request = Net::HTTP::Post.new(url.request_uri)
      request.set_form([["mesh", file]], "multipart/form-data")
      connection.request(request)
    end
  end
end

def pause(url, path, seconds, rounds, connections)
  mesh = File.binread(path)
  threads = Array.new(connections) do
    Thread.new do
      connection = connect(url)
      (0..rounds).each do |round|
        sleep(seconds) if round.positive?
        report("pause") { connection.request(post(url, mesh)) }
      end
    end
  end
  threads.each(&:join)
end

# Gives so many bytes, so many a second.
class SlowSource
  def initialize(size, rate)
    @size = size
    @rate = rate
    @given = 0
    @began = Process.clock_gettime(Process::CLOCK_MONOTONIC)
  end

  def readpartial(most, buffer = +"")
    raise EOFError if @given == @size

    due = @began + @given.fdiv(@rate) - Process.clock_gettime(Process::CLOCK_MONOTONIC)
    sleep(due) if due.positive?
    piece = "#" * [most, @size - @given, 65_536].min
    @given += piece.size
    buffer.replace(piece)
  end

  def read(most, buffer = +"")
    readpartial(most, buffer)
  rescue EOFError
    nil
  end
end

def early(url, size, rate)
  report("stream") { connect(url).request(stream(url, SlowSource.new(size, rate))) }
end

command, url, *rest = ARGV
url = URI(url)
case command
when "upload" then upload(url, rest[0])
when "pause" then pause(url, rest[0], rest[1].to_f, rest[2].to_i, rest[3].to_i)
when "early" then early(url, rest[0].to_i, rest[1].to_i)
end
