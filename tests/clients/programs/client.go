// Go's net/http as a client. README.md in this folder describes the commands.
package main

import (
	"bytes"
	"crypto/sha256"
	"fmt"
	"io"
	"mime/multipart"
	"net/http"
	"os"
	"strconv"
	"sync"
	"time"
)

const mediaType = "model/obj"

var printing sync.Mutex

func report(style string, answer *http.Response, err error) {
	status, rest := "lost", ""
	if err == nil {
		var body []byte
		body, err = io.ReadAll(answer.Body)
		answer.Body.Close()
		if err == nil {
			status, rest = strconv.Itoa(answer.StatusCode), fmt.Sprintf("%x", sha256.Sum256(body))
		}
	}
	if err != nil {
		rest = err.Error()
	}
	printing.Lock()
	defer printing.Unlock()
	fmt.Printf("Go, %s | %s | %s\n", style, status, rest)
}

func uploadForm(url, path string, mesh []byte) (*http.Response, error) {
	var body bytes.Buffer
	form := multipart.NewWriter(&body)
	part, err := form.CreateFormFile("mesh", path)
	if err != nil {
		return nil, err
	}
	part.Write(mesh)
	form.Close()
	return http.Post(url, form.FormDataContentType(), &body)
}

func upload(url, path string) {
	mesh, err := os.ReadFile(path)
	if err != nil {
		panic(err)
	}
	answer, err := http.Post(url, mediaType, bytes.NewReader(mesh))
	report("whole", answer, err)
	// The length of this reader is unknown, so that Go sends the body in chunks.
	answer, err = http.Post(url, mediaType, io.MultiReader(bytes.NewReader(mesh)))
	report("stream", answer, err)
	answer, err = uploadForm(url, path, mesh)
	report("form", answer, err)
}

func pause(url, path string, seconds float64, rounds, connections int) {
	mesh, err := os.ReadFile(path)
	if err != nil {
		panic(err)
	}
	var running sync.WaitGroup
	for range make([]struct{}, connections) {
		running.Add(1)
		go func() {
			defer running.Done()
			client := http.Client{Transport: &http.Transport{}}
			for round := 0; round <= rounds; round++ {
				if round > 0 {
					time.Sleep(time.Duration(seconds * float64(time.Second)))
				}
				answer, err := client.Post(url, mediaType, bytes.NewReader(mesh))
				report("pause", answer, err)
			}
		}()
	}
	running.Wait()
}

// A slowReader gives so many bytes, so many a second.
type slowReader struct {
	left, given, rate int
	began             time.Time
}

func (reader *slowReader) Read(buffer []byte) (int, error) {
	if reader.left == 0 {
		return 0, io.EOF
	}
	due := reader.began.Add(time.Duration(float64(reader.given) / float64(reader.rate) * float64(time.Second)))
	time.Sleep(time.Until(due))
	count := min(len(buffer), min(reader.left, 65536))
	for index := range buffer[:count] {
		buffer[index] = '#'
	}
	reader.left -= count
	reader.given += count
	return count, nil
}

func min(a, b int) int {
	if a < b {
		return a
	}
	return b
}

func early(url string, size, rate int) {
	answer, err := http.Post(url, mediaType, &slowReader{left: size, rate: rate, began: time.Now()})
	report("stream", answer, err)
}

func number(text string) float64 {
	value, err := strconv.ParseFloat(text, 64)
	if err != nil {
		panic(err)
	}
	return value
}

func main() {
	arguments := os.Args[2:]
	switch os.Args[1] {
	case "upload":
		upload(arguments[0], arguments[1])
	case "pause":
		pause(arguments[0], arguments[1], number(arguments[2]), int(number(arguments[3])), int(number(arguments[4])))
	case "early":
		early(arguments[0], int(number(arguments[1])), int(number(arguments[2])))
	}
}
