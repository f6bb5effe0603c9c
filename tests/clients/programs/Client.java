// Java's HttpURLConnection and java.net.http as clients. README.md in this folder describes the commands.

import java.io.ByteArrayInputStream;
import java.io.ByteArrayOutputStream;
import java.io.IOException;
import java.io.InputStream;
import java.net.HttpURLConnection;
import java.net.URI;
import java.net.http.HttpClient;
import java.net.http.HttpRequest;
import java.net.http.HttpRequest.BodyPublisher;
import java.net.http.HttpRequest.BodyPublishers;
import java.net.http.HttpResponse;
import java.net.http.HttpResponse.BodyHandlers;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Path;
import java.security.MessageDigest;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.HexFormat;
import java.util.List;

public class Client {
  private static final String MEDIA_TYPE = "model/obj";
  private static final String BOUNDARY = "a-boundary-of-the-client-in-java";

  private record Answer(int status, byte[] body) {}

  private interface Request {
    Answer send() throws Exception;
  }

  private static void report(String style, Request request) {
    String line;
    try {
      Answer answer = request.send();
      byte[] sum = MessageDigest.getInstance("SHA-256").digest(answer.body());
      line = answer.status() + " | " + HexFormat.of().formatHex(sum);
    } catch (Exception error) {
      line = "lost | " + error;
    }
    System.out.println("Java, " + style + " | " + line);
  }

  /** Uploads what the stream gives, in chunks if the length is negative. */
  private static Answer sendOld(String url, String mediaType, InputStream body, int length) throws IOException {
    HttpURLConnection connection = (HttpURLConnection) URI.create(url).toURL().openConnection();
    connection.setRequestMethod("POST");
    connection.setRequestProperty("Content-Type", mediaType);
    connection.setDoOutput(true);
    if (length < 0) {
      connection.setChunkedStreamingMode(0);
    } else {
      connection.setFixedLengthStreamingMode(length);
    }
    try (var out = connection.getOutputStream()) {
      body.transferTo(out);
    }
    int status = connection.getResponseCode();
    try (InputStream in = status < 400 ? connection.getInputStream() : connection.getErrorStream()) {
      return new Answer(status, in == null ? new byte[0] : in.readAllBytes());
    }
  }

  private static Answer sendNew(HttpClient client, String url, String mediaType, BodyPublisher body) throws Exception {
    HttpRequest request = HttpRequest.newBuilder(URI.create(url)).header("Content-Type", mediaType).POST(body).build();
    HttpResponse<byte[]> answer = client.send(request, BodyHandlers.ofByteArray());
    return new Answer(answer.statusCode(), answer.body());
  }

  private static byte[] form(byte[] mesh) throws IOException {
    var form = new ByteArrayOutputStream();
    form.write(("--" + BOUNDARY + "\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"part.obj\"\r\n\r\n")
        .getBytes(StandardCharsets.US_ASCII));
    form.write(mesh);
    form.write(("\r\n--" + BOUNDARY + "--\r\n").getBytes(StandardCharsets.US_ASCII));
    return form.toByteArray();
  }

  /** A client with the defaults of most programs: it offers HTTP/2 by an upgrade. */
  private static HttpClient newClient() {
    return HttpClient.newHttpClient();
  }

  private static void upload(String url, Path path) throws Exception {
    byte[] mesh = Files.readAllBytes(path);
    byte[] form = form(mesh);
    String formType = "multipart/form-data; boundary=" + BOUNDARY;
    report("HttpURLConnection, whole",
        () -> sendOld(url, MEDIA_TYPE, new ByteArrayInputStream(mesh), mesh.length));
    report("HttpURLConnection, stream", () -> sendOld(url, MEDIA_TYPE, new ByteArrayInputStream(mesh), -1));
    report("HttpURLConnection, form", () -> sendOld(url, formType, new ByteArrayInputStream(form), form.length));
    HttpClient client = newClient();
    report("java.net.http, whole", () -> sendNew(client, url, MEDIA_TYPE, BodyPublishers.ofByteArray(mesh)));
    report("java.net.http, stream", () -> sendNew(client, url, MEDIA_TYPE,
        BodyPublishers.ofInputStream(() -> new ByteArrayInputStream(mesh))));
    report("java.net.http, form", () -> sendNew(client, url, formType, BodyPublishers.ofByteArray(form)));
  }

  private static Thread startRounds(String style, double seconds, int rounds, Request request) {
    Thread thread = new Thread(() -> {
      for (int round = 0; round <= rounds; ++round) {
        try {
          Thread.sleep(round == 0 ? 0 : (long) (seconds * 1000));
        } catch (InterruptedException error) {
          return;
        }
        report(style, request);
      }
    });
    thread.start();
    return thread;
  }

  private static void pause(String url, Path path, double seconds, int rounds, int connections) throws Exception {
    byte[] mesh = Files.readAllBytes(path);
    List<Thread> threads = new ArrayList<>();
    for (int number = 0; number < connections; ++number) {
      threads.add(startRounds("HttpURLConnection, pause", seconds, rounds,
          () -> sendOld(url, MEDIA_TYPE, new ByteArrayInputStream(mesh), mesh.length)));
      HttpClient client = newClient();
      threads.add(startRounds("java.net.http, pause", seconds, rounds,
          () -> sendNew(client, url, MEDIA_TYPE, BodyPublishers.ofByteArray(mesh))));
    }
    for (Thread thread : threads) {
      thread.join();
    }
  }

  /** Gives so many bytes, so many a second. */
  private static class SlowStream extends InputStream {
    private final long size;
    private final double rate;
    private final long began = System.nanoTime();
    private long given;

    SlowStream(long size, double rate) {
      this.size = size;
      this.rate = rate;
    }

    @Override
    public int read() throws IOException {
      byte[] one = new byte[1];
      return read(one, 0, 1) < 0 ? -1 : one[0];
    }

    @Override
    public int read(byte[] buffer, int offset, int length) throws IOException {
      if (given == size) {
        return -1;
      }
      try {
        Thread.sleep(Math.max(0, (long) (given / rate * 1000) - (System.nanoTime() - began) / 1_000_000));
      } catch (InterruptedException error) {
        throw new IOException(error);
      }
      int count = (int) Math.min(length, Math.min(size - given, 65536));
      Arrays.fill(buffer, offset, offset + count, (byte) '#');
      given += count;
      return count;
    }
  }

  private static void early(String url, int size, double rate) {
    report("HttpURLConnection, whole", () -> sendOld(url, MEDIA_TYPE, new SlowStream(size, rate), size));
    report("HttpURLConnection, stream", () -> sendOld(url, MEDIA_TYPE, new SlowStream(size, rate), -1));
    report("java.net.http, stream", () -> sendNew(newClient(), url, MEDIA_TYPE,
        BodyPublishers.ofInputStream(() -> new SlowStream(size, rate))));
  }

  public static void main(String[] arguments) throws Exception {
    // Its silent second attempt would hide what the daemon loses.
    System.setProperty("sun.net.http.retryPost", "false");
    System.setProperty("http.maxConnections", "100");
    String url = arguments[1];
    switch (arguments[0]) {
      case "upload" -> upload(url, Path.of(arguments[2]));
      case "pause" -> pause(url, Path.of(arguments[2]), Double.parseDouble(arguments[3]),
          Integer.parseInt(arguments[4]), Integer.parseInt(arguments[5]));
      default -> early(url, Integer.parseInt(arguments[2]), Double.parseDouble(arguments[3]));
    }
    System.exit(0); // Otherwise the threads of java.net.http would keep the program alive for a while.
  }
}
