// Requests to the server, which is the one that this page came from.

export class Refused extends Error {
  constructor(message, status) {
    super(message);
    this.status = status;
  }
}

export const GONE =
  "The server does not answer: it was ended, or the machine is busy. Your corrections are in the file; run the same `moseg view` again.";

const ask = async (address, options) => {
  let response;
  try {
    response = await fetch(address, options);
  } catch {
    throw new Refused(GONE, 0);
  }
  if (response.ok) return response;
  const text = await response.text();
  let message = text.trim();
  try {
    message = JSON.parse(text).message;
  } catch {
    // A refusal of the guard is plain text.
  }
  throw new Refused(message, response.status);
};

export const getJson = async (address) => (await ask(address)).json();

export const getBytes = async (address) => (await ask(address)).arrayBuffer();

export const getBlob = async (address) => {
  const response = await ask(address);
  return response.status === 204 ? null : response.blob();
};

export const post = async (address, content) =>
  (
    await ask(address, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(content),
    })
  ).json();

// Uploads a file with its progress, a share from 0 to 1.
export const upload = (file, onProgress) =>
  new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("PUT", "upload");
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.setRequestHeader("X-File-Name", encodeURIComponent(file.name));
    request.upload.addEventListener("progress", (event) => onProgress(event.loaded / Math.max(event.total, 1)));
    request.addEventListener("error", () => reject(new Refused(GONE, 0)));
    request.addEventListener("load", () => {
      if (request.status < 300) resolve();
      else {
        let message = request.responseText;
        try {
          message = JSON.parse(message).message;
        } catch {
          // Plain text.
        }
        reject(new Refused(message, request.status));
      }
    });
    request.send(file);
  });

// Listens to the server; tries again by itself where the connection is lost.
export const listen = (onState, onProgress, onConnection) => {
  const events = new EventSource("events");
  events.addEventListener("state", (event) => onState(JSON.parse(event.data)));
  events.addEventListener("progress", (event) => onProgress(JSON.parse(event.data)));
  events.addEventListener("open", () => onConnection(true));
  events.addEventListener("error", () => onConnection(false));
};
